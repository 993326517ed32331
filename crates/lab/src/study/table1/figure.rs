//! Figure 3 of Lee (2010) redrawn: condition numbers against 1/H_b, H_b/H_s and H_s/h, the paper's points and ours.

use std::path::{Path, PathBuf};

use super::paper;
use super::record::Table1Row;
use base::Result;
use report::drawing::canvas::Colour;
use report::drawing::ticks::Scale;
use report::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series};

/// The size of a row that varies in a panel; the other two are 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum VariedSize {
    Bodies,
    Subdomains,
    Elements,
}

impl VariedSize {
    const ALL: [VariedSize; 3] = [
        VariedSize::Bodies,
        VariedSize::Subdomains,
        VariedSize::Elements,
    ];

    /// The value on the horizontal axis for a row of this family; `None` for other rows.
    fn abscissa(self, bodies: usize, subdomains: usize, elements: usize) -> Option<f64> {
        let (x, others) = match self {
            VariedSize::Bodies => (bodies, [subdomains, elements]),
            VariedSize::Subdomains => (subdomains, [bodies, elements]),
            VariedSize::Elements => (elements, [bodies, subdomains]),
        };
        (others == [2, 2]).then_some(x as f64)
    }

    fn axis(self) -> Axis {
        match self {
            VariedSize::Bodies => Axis::new("1/H_{b}  (bodies across)", Scale::Linear),
            VariedSize::Subdomains => {
                Axis::new("H_{b}/H_{s}  (subdomains across a body)", Scale::Linear)
            }
            VariedSize::Elements => Axis::new("H_{s}/h  (elements across a subdomain)", Scale::Log),
        }
    }

    fn title(self) -> &'static str {
        match self {
            VariedSize::Bodies => "H_{b}/H_{s} = 2, H_{s}/h = 2",
            VariedSize::Subdomains => "1/H_{b} = 2, H_{s}/h = 2",
            VariedSize::Elements => "1/H_{b} = 2, H_{b}/H_{s} = 2",
        }
    }
}

/// The figure for some rows of Table 1; rows outside the three families of the paper are not shown. Where no exact κ is
/// known, the estimate of the solve is shown instead.
pub fn figure(rows: &[Table1Row]) -> Figure {
    let panels = VariedSize::ALL
        .into_iter()
        .map(|family| panel(family, rows))
        .collect();
    Figure::new("Condition numbers of the FETI-FETI method", panels)
}

/// Writes `stem`.png and `stem`.svg; returns their paths.
///
/// # Errors
/// [`base::ErrorKind::Environment`] with the path.
pub fn figure3(rows: &[Table1Row], stem: &Path) -> Result<Vec<PathBuf>> {
    figure(rows).save(stem)
}

fn panel(family: VariedSize, rows: &[Table1Row]) -> Panel {
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

    let [blue, red, light_blue, light_red] = [0, 1, 5, 4].map(|k| Colour::CYCLE[k]);
    let paper = |label: &str, cond: fn(&paper::PaperRow) -> f64, colour, marker| {
        let points = printed.iter().map(|(x, r)| (*x, cond(r))).collect();
        let series = Series::new(label, points, colour);
        series.marker(marker, false, 6.5).line(LineStyle::None)
    };
    let ours = |label: &str, kappa: fn(&Table1Row) -> Option<f64>, colour, marker, line| {
        let points = rows.iter().filter_map(|(x, r)| Some((*x, kappa(r)?)));
        let series = Series::new(label, points.collect(), colour);
        series.marker(marker, true, 3.4).line(line)
    };
    let with_m_d: [fn(&Table1Row) -> Option<f64>; 2] = [
        |r| r.whole_interface.dirichlet.kappa(),
        |r| r.middle_third.dirichlet.kappa(),
    ];
    let with_m_c: [fn(&Table1Row) -> Option<f64>; 2] = [
        |r| r.whole_interface.coarse_corrected.kappa(),
        |r| r.middle_third.coarse_corrected.kappa(),
    ];
    let (dashed, diamond, triangle) = (LineStyle::Dashed, Marker::Diamond, Marker::Triangle);
    // The paper's hollow markers come first: ours fill them where both agree.
    let series = vec![
        paper(
            "(I) paper, M_{D}",
            |r| r.whole_interface.cond,
            blue,
            Marker::Circle,
        ),
        paper(
            "(II) paper, M_{D}",
            |r| r.middle_third.cond,
            red,
            Marker::Square,
        ),
        ours(
            "(I) ours, M_{D}",
            with_m_d[0],
            blue,
            Marker::Circle,
            LineStyle::Full,
        ),
        ours(
            "(II) ours, M_{D}",
            with_m_d[1],
            red,
            Marker::Square,
            LineStyle::Full,
        ),
        ours("(I) ours, M_{C}", with_m_c[0], light_blue, diamond, dashed),
        ours("(II) ours, M_{C}", with_m_c[1], light_red, triangle, dashed),
    ];
    let abscissas: Vec<f64> = printed.iter().map(|(x, _)| *x).collect();
    let y = Axis::new("condition number κ", Scale::Linear);
    Panel::new(family.title(), family.axis().at(abscissas), y, series)
}

#[cfg(test)]
#[path = "../../../tests/study/table1/figure.rs"]
mod tests;
