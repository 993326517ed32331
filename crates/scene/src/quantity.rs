//! The values that quantities may have.

use super::model::body::BodySpec;
use super::model::field::Field;
use base::Result;
use elements::form::Form;
use mesh::FARTHEST;

/// A quantity that a body has by points: its name in messages, and the values that it may have.
pub(super) struct Quantity {
    name: &'static str,
    pub good: fn(f64) -> bool,
    wanted: &'static str,
}

/// Largest size of a coefficient, a load or a given value, and the inverse of the smallest of a coefficient: squares
/// and products of what follows from them must be numbers.
pub(super) const LARGEST: f64 = 1e100;

/// Largest edge, coordinate, gap and bound, and the inverse of the smallest edge: a volume is the third power.
pub(super) const LONGEST: f64 = FARTHEST;

/// The expectation that this gap or bound fails, for the message; `None` if the value is permitted.
pub(super) fn unfit_length(value: f64) -> Option<String> {
    match value {
        v if !v.is_finite() => Some("a finite number was expected".into()),
        v if v.abs() > LONGEST => Some(format!(
            "at most {LONGEST:e} was expected (take other units)"
        )),
        _ => None,
    }
}

/// The largest coordinate of a mesh, and what was expected, if areas and volumes would be no numbers.
pub(super) fn unfit_size(points: &[[f64; 3]]) -> Option<(f64, String)> {
    let all = points.iter().flatten().map(|x| x.abs());
    let size = all.fold(0.0, f64::max);
    match size {
        s if s > LONGEST => Some((size, format!("at most {LONGEST:e}"))),
        s if s < 1.0 / LONGEST => Some((size, format!("at least {:e}", 1.0 / LONGEST))),
        _ => None,
    }
}

/// The coefficient of a scalar problem.
const RHO: Quantity = Quantity {
    name: "ρ =",
    good: |v| (1.0 / LARGEST..=LARGEST).contains(&v),
    wanted: "a positive number",
};

/// Young's modulus.
const YOUNG: Quantity = Quantity { name: "E =", ..RHO };

/// Poisson's ratio.
pub(super) const RATIO: Quantity = Quantity {
    name: "ν =",
    good: |v| v > -1.0 && v < 0.5,
    wanted: "a number above -1 and below 1/2",
};

/// A component of a load.
pub(super) const LOAD: Quantity = Quantity {
    name: "load",
    good: |v| v.abs() <= LARGEST,
    wanted: "a finite number",
};

/// A temperature.
pub(super) const TEMPERATURE: Quantity = Quantity {
    name: "temperature",
    ..LOAD
};

/// The stiffness of an elastic foundation.
pub(super) const SPRING: Quantity = Quantity {
    name: "spring",
    good: |v| (0.0..=LARGEST).contains(&v),
    wanted: "a finite number of at least 0",
};

impl Quantity {
    /// ρ or E.
    pub fn coefficient(form: &Form) -> Quantity {
        if form.is_elastic() {
            YOUNG
        } else {
            RHO
        }
    }

    /// A value at a point, checked.
    pub fn at(&self, body: &BodySpec, value: f64, point: [f64; 3]) -> Result<f64> {
        if (self.good)(value) {
            Ok(value)
        } else {
            self.refuse(body, value, &format!(" at {}", body.spot_at(point)))
        }
    }

    /// The error of a value; `place` says where it is.
    fn refuse<T>(&self, body: &BodySpec, value: f64, place: &str) -> Result<T> {
        let Quantity { name, wanted, .. } = self;
        let [low, high] = [1.0 / LARGEST, LARGEST];
        if value.is_finite() && (value > high || value < -high || value > 0.0 && value < low) {
            return body.error(format!(
                "{name} {value:e}{place} where a size between {low:e} and {high:e} was expected (take other units)"
            ));
        }
        body.error(format!("{name} {value}{place} where {wanted} was expected"))
    }

    /// Checks the values of a field that are known without evaluation.
    pub fn check(&self, body: &BodySpec, field: &Field) -> Result<()> {
        let wrong = |value: &f64| !(self.good)(*value);
        let Some(value) = field.known_values().into_iter().find(wrong) else {
            return Ok(());
        };
        let found = match field {
            Field::Cells(cells) => cells.find(|v| wrong(&v))?,
            _ => None,
        };
        match found {
            Some((value, cell)) => self.refuse(body, value, &format!(" in {cell}")),
            None => self.refuse(body, value, ""),
        }
    }
}
