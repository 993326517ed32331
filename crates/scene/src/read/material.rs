//! `material` of a body: laws that are not isotropic, by constants along axes of their own; and its expansion by heat.

use super::document::{Item, TableSection, Value};
use super::fields::FieldSizes;
use super::SceneReader;
use crate::model::body::BodySpec;
use crate::model::field::Field;
use crate::model::heat::Temperature;
use crate::model::law::{axes_of, LawSpec, MaterialAxes, OrientedLaw};
use base::linalg::orthogonal::IDENTITY;
use base::linalg::vec3::unit;
use base::Result;
use elements::law::{Anisotropic, Constants, Orthotropic, Transverse};

/// A reader of constants.
type Reader = fn(&SceneReader, &Item) -> Result<Box<dyn Constants>>;

/// The laws: their keys in `material`.
const LAWS: [(&str, Reader); 3] = [
    ("orthotropic", orthotropic),
    ("transverse", transverse),
    ("anisotropic", anisotropic),
];

fn orthotropic(reader: &SceneReader, item: &Item) -> Result<Box<dyn Constants>> {
    let mut section = item.section("`orthotropic`")?;
    let along = "three numbers along the axes of the material";
    let between = "three numbers for 12, 13 and 23";
    let law = Orthotropic {
        young: reader.several(section.need("young", along)?, along)?,
        poisson: reader.several(section.need("poisson", between)?, between)?,
        shear: reader.several(section.need("shear", between)?, between)?,
    };
    section.finish()?;
    Ok(Box::new(law))
}

fn transverse(reader: &SceneReader, item: &Item) -> Result<Box<dyn Constants>> {
    let mut section = item.section("`transverse`")?;
    let both = "two numbers, along the first axis and across it";
    let law = Transverse {
        young: reader.several(section.need("young", both)?, both)?,
        poisson: reader.several(section.need("poisson", both)?, both)?,
        shear: reader.number(section.need("shear", "a number")?)?,
    };
    section.finish()?;
    Ok(Box::new(law))
}

fn anisotropic(reader: &SceneReader, item: &Item) -> Result<Box<dyn Constants>> {
    let wanted = "21 numbers D_1111, D_1122, D_2222, …, D_2323";
    Ok(Box::new(Anisotropic(reader.several(item, wanted)?)))
}

impl SceneReader {
    /// `material` of a body, in place of `young` and `poisson`.
    pub(super) fn material(&self, item: &Item, body: &mut BodySpec) -> Result<()> {
        let mut section = item.section("`material`")?;
        let mut found = Vec::new();
        for (key, read) in LAWS {
            found.extend(section.read(key, |item| {
                let tangent = read(self, item)?.tangent();
                tangent.or_else(|clause| item.error(format!("{key}: {clause}")))
            })?);
        }
        let axes = self.axes(&mut section)?;
        section.finish()?;
        let names = LAWS.map(|(key, _)| format!("`{key}`")).join(", ");
        let tangent = item.only(found, "`material`", "laws", &names)?;
        let (young, poisson) = tangent.mean();
        body.rho = Field::constant(young);
        body.poisson = Field::constant(poisson);
        body.law = Some(LawSpec::everywhere(OrientedLaw { tangent, axes }));
        Ok(())
    }

    /// `expansion`, `temperature` and `reference` of a body: each key that is there replaces what the body has.
    pub(super) fn heat(
        &self,
        section: &mut TableSection,
        shape: &FieldSizes,
        body: &mut BodySpec,
    ) -> Result<()> {
        let mut heat = body.heat.clone().unwrap_or_default();
        let expansion = section.read("expansion", |item| match item.value {
            Value::List(_) => self.several(item, "three numbers along the axes of the material"),
            _ => Ok([self.number(item)?; 3]),
        })?;
        let lost = section.entry("temperature");
        let temperature = section.read("temperature", |item| self.field(item, shape, 0.0))?;
        let reference = section.read("reference", |item| self.number(item))?;
        if expansion.is_none() && temperature.is_none() && reference.is_none() {
            return Ok(());
        }
        if let Some(expansion) = expansion {
            heat.expansion = vec![expansion];
        }
        if let Some((field, _)) = temperature {
            heat.temperature = Some(Temperature::Field(field));
        }
        heat.reference = reference.unwrap_or(heat.reference);
        if let Some(item) = lost.filter(|_| heat.expansion.is_empty()) {
            return item.error("`temperature` without `expansion`, of which it is the cause");
        }
        body.heat = Some(heat);
        Ok(())
    }

    /// `axes`: two vectors, or a cylinder.
    fn axes(&self, section: &mut TableSection) -> Result<MaterialAxes> {
        let Some(item) = section.take("axes") else {
            return Ok(MaterialAxes::Fixed(IDENTITY));
        };
        let wanted = ["two vectors [x, y]", "two vectors [x, y, z]"][self.dim - 2];
        if matches!(item.value, Value::Table(_)) {
            let mut table = item.section("`axes`")?;
            let cylinder = table.need("cylinder", "the axis of a cylinder")?;
            table.finish()?;
            return self.cylinder(cylinder);
        }
        let [first, second] = item.list(wanted)? else {
            return item.expected(wanted);
        };
        let vector = |item| self.vector(item, wanted);
        match axes_of(vector(first)?, vector(second)?) {
            Some(axes) => Ok(MaterialAxes::Fixed(axes)),
            None => item.error("two parallel vectors where those of two axes were expected"),
        }
    }

    /// Axes that are radial, around and along an axis.
    fn cylinder(&self, item: &Item) -> Result<MaterialAxes> {
        let mut section = item.section("`cylinder`")?;
        let point = ["a point [x, y]", "a point [x, y, z]"][self.dim - 2];
        let centre = section.read("centre", |item| self.vector(item, point))?;
        let mut axis = [0.0, 0.0, 1.0];
        if self.dim == 3 {
            let item = section.need("axis", "a vector [x, y, z]")?;
            match unit(self.vector(item, "a vector [x, y, z]")?) {
                Some(found) => axis = found,
                None => return item.error("the vector 0 where a direction was expected"),
            }
        }
        section.finish()?;
        Ok(MaterialAxes::Cylinder {
            centre: centre.unwrap_or_default(),
            axis,
            turn: IDENTITY,
        })
    }

    /// So many numbers.
    fn several<const N: usize>(&self, item: &Item, wanted: &str) -> Result<[f64; N]> {
        let list = item.list(wanted)?;
        if list.len() != N {
            return item.error(format!(
                "a list of {} where {wanted} was expected",
                list.len()
            ));
        }
        let mut out = [0.0; N];
        for (value, item) in out.iter_mut().zip(list) {
            *value = self.number(item)?;
        }
        Ok(out)
    }
}
