//! Figure 3 of Lee (2010) redrawn: condition numbers against 1/H_b, H_b/H_s and H_s/h, the paper's points and ours.

use super::plot::{Axis, Figure, Line, Marker, Panel, Series};
use crate::report::drawing::canvas::Colour;
use crate::report::drawing::ticks::Scale;
use crate::report::json::{Table1Row, Table1Side};
use crate::report::tables::paper;
use crate::Result;
use std::path::{Path, PathBuf};

/// The size of a row that varies in a panel; the other two are 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Family {
    Bodies,
    Subdomains,
    Elements,
}

impl Family {
    const ALL: [Family; 3] = [Family::Bodies, Family::Subdomains, Family::Elements];

    /// The value on the horizontal axis for a row of this family; `None` for other rows.
    fn abscissa(self, bodies: usize, subdomains: usize, elements: usize) -> Option<f64> {
        let (x, others) = match self {
            Family::Bodies => (bodies, [subdomains, elements]),
            Family::Subdomains => (subdomains, [bodies, elements]),
            Family::Elements => (elements, [bodies, subdomains]),
        };
        (others == [2, 2]).then_some(x as f64)
    }

    fn axis(self) -> Axis {
        match self {
            Family::Bodies => Axis::new("1/H_{b}  (bodies across)", Scale::Linear),
            Family::Subdomains => {
                Axis::new("H_{b}/H_{s}  (subdomains across a body)", Scale::Linear)
            }
            Family::Elements => Axis::new("H_{s}/h  (elements across a subdomain)", Scale::Log),
        }
    }

    fn title(self) -> &'static str {
        match self {
            Family::Bodies => "H_{b}/H_{s} = 2, H_{s}/h = 2",
            Family::Subdomains => "1/H_{b} = 2, H_{s}/h = 2",
            Family::Elements => "1/H_{b} = 2, H_{b}/H_{s} = 2",
        }
    }
}

/// The figure for some rows of Table 1; rows outside the three families of the paper are not shown. Where no exact κ is
/// known, the estimate of the solve is shown instead.
pub fn figure(rows: &[Table1Row]) -> Figure {
    let panels = Family::ALL
        .into_iter()
        .map(|family| panel(family, rows))
        .collect();
    Figure::new("Condition numbers of the FETI-FETI method", panels)
}

/// Writes `stem`.png and `stem`.svg; returns their paths.
///
/// # Errors
/// [`crate::Error::Environment`] with the path.
pub fn figure3(rows: &[Table1Row], stem: &Path) -> Result<Vec<PathBuf>> {
    figure(rows).save(stem)
}

fn panel(family: Family, rows: &[Table1Row]) -> Panel {
    let mut rows: Vec<(f64, &Table1Row)> = rows
        .iter()
        .filter_map(|r| Some((family.abscissa(r.bodies, r.subdomains, r.elements)?, r)))
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut printed: Vec<(f64, paper::PaperRow)> = paper::table1()
        .into_iter()
        .filter_map(|r| Some((family.abscissa(r.bodies, r.subdomains, r.elements)?, r)))
        .collect();
    printed.sort_by(|a, b| a.0.total_cmp(&b.0));

    let ours = |value: fn(&Table1Row) -> Option<f64>| {
        rows.iter()
            .filter_map(|(x, r)| Some((*x, value(r)?)))
            .collect::<Vec<_>>()
    };
    let (blue, red) = (Colour::CYCLE[0], Colour::CYCLE[1]);
    let (light_blue, light_red) = (Colour::CYCLE[5], Colour::CYCLE[4]);
    // The paper's hollow markers come first: ours fill them where both agree.
    let series = vec![
        Series::new(
            "(I) paper, M_{D}",
            printed
                .iter()
                .map(|(x, r)| (*x, r.whole_interface.cond))
                .collect(),
            blue,
        )
        .marker(Marker::Circle, false, 6.5)
        .line(Line::None),
        Series::new(
            "(II) paper, M_{D}",
            printed
                .iter()
                .map(|(x, r)| (*x, r.middle_third.cond))
                .collect(),
            red,
        )
        .marker(Marker::Square, false, 6.5)
        .line(Line::None),
        Series::new(
            "(I) ours, M_{D}",
            ours(|r| with_m_d(&r.whole_interface)),
            blue,
        )
        .marker(Marker::Circle, true, 3.4),
        Series::new("(II) ours, M_{D}", ours(|r| with_m_d(&r.middle_third)), red).marker(
            Marker::Square,
            true,
            3.4,
        ),
        Series::new(
            "(I) ours, M_{C}",
            ours(|r| with_m_c(&r.whole_interface)),
            light_blue,
        )
        .marker(Marker::Diamond, true, 3.4)
        .line(Line::Dashed),
        Series::new(
            "(II) ours, M_{C}",
            ours(|r| with_m_c(&r.middle_third)),
            light_red,
        )
        .marker(Marker::Triangle, true, 3.4)
        .line(Line::Dashed),
    ];
    let abscissas: Vec<f64> = printed.iter().map(|(x, _)| *x).collect();
    Panel {
        title: family.title().to_string(),
        x: family.axis().at(abscissas),
        y: Axis::new("condition number κ", Scale::Linear),
        series,
        bands: Vec::new(),
    }
}

fn with_m_d(side: &Table1Side) -> Option<f64> {
    side.exact.or(side.estimate)
}

fn with_m_c(side: &Table1Side) -> Option<f64> {
    side.coarse_corrected
        .exact
        .or(side.coarse_corrected.estimate)
}

#[cfg(test)]
#[path = "../../../tests/inside/report/plots/figure3.rs"]
mod tests;
