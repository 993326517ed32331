//! The fields as files for ParaView.

use std::path::Path;

use super::{GatherTarget, Gathered};
use crate::first_rank::on_first_rank;
use crate::friction;
use crate::smoothed::smoothed;
use base::Result;
use elements::cell::CellStress;
use elements::element::{principal_stresses, NodeStress};
use fetifeti::solution::SolvedRow;
use fetifeti::Solution;
use parallel::exchange::any;
use petsc::Session;
use report::paraview::contact_fields::ContactFields;
use report::paraview::vtu::Vtu;
use scene::assembly::recovery::components;
use scene::{distribution, Scene};

impl GatherTarget {
    /// The name of the file for ParaView.
    pub fn file(self, name: &str) -> String {
        match self {
            GatherTarget::FirstRank => format!("{name}.vtu"),
            GatherTarget::EachRank => format!("{name}.pvtu"),
        }
    }
}

/// The file of one rank.
fn piece(name: &str, rank: usize) -> String {
    format!("{name}_{rank:04}.vtu")
}

/// The rows of contact near the points of a grid, and what there is on any rank: pieces of a grid have the same arrays.
struct ContactRows<'a> {
    rows: &'a [SolvedRow],
    /// The rows of friction, those of a node one after the other.
    tangential: &'a [SolvedRow],
    /// Whether some sides may touch.
    contact: bool,
    /// Whether some have friction.
    friction: bool,
}

impl Gathered {
    /// Writes `NAME.vtu` into `dir`, or a piece from every rank and `NAME.pvtu`. `rows` and `tangential` are those of
    /// all ranks on rank 0. Collective.
    pub fn write_vtu(
        &self,
        session: &Session,
        scene: &Scene,
        solution: &Solution,
        (rows, tangential): (&[SolvedRow], &[SolvedRow]),
        dir: &Path,
        name: &str,
    ) -> Result<()> {
        let path = dir.join(self.place.file(name));
        let own = solution.rows();
        let sheared = solution.tangential_rows();
        let has = |rows: &[SolvedRow], of: fn(&SolvedRow) -> bool| {
            any(session.comm(), rows.iter().any(of))
        };
        let contact = has(own, SolvedRow::is_inequality);
        let friction = has(sheared, |row| row.law.is_friction());
        let shown = |rows, tangential| ContactRows {
            rows,
            tangential,
            contact,
            friction,
        };
        if self.place == GatherTarget::FirstRank {
            let shown = shown(rows, tangential);
            return on_first_rank(session, || {
                self.grid(scene, &shown, &mut |grid| grid.write(&path))
            });
        }
        let ranks_of = distribution::ranks_of(session, scene)?;
        let rows = SolvedRow::near_bodies(session.comm(), own, &ranks_of);
        let mut tangential = SolvedRow::near_bodies(session.comm(), sheared, &ranks_of);
        tangential.sort_by(SolvedRow::by_place);
        let shown = shown(&rows, &tangential);
        let pieces: Vec<String> = (0..session.size()).map(|r| piece(name, r)).collect();
        let mine = dir.join(&pieces[session.rank()]);
        session.agree(self.grid(scene, &shown, &mut |grid| grid.write(&mine)))?;
        // ParaView finds the index only when its pieces are there.
        on_first_rank(session, || {
            let write = &mut |grid: &Vtu| grid.write_index(&path, &pieces);
            self.grid(scene, &shown, write)
        })
    }

    /// The grid with all its data, for `write`; that of contact, if there is any on any rank.
    fn grid(
        &self,
        scene: &Scene,
        shown: &ContactRows,
        write: &mut dyn FnMut(&Vtu) -> Result<()>,
    ) -> Result<()> {
        let whole = |list: &[u32]| list.iter().map(|&k| k as i32).collect::<Vec<i32>>();
        let [body, subdomain, rank] = [&self.body, &self.subdomain, &self.rank].map(|l| whole(l));
        let contact = shown.contact.then(|| self.contact_fields(scene, shown));
        let contact = contact.transpose()?;
        let (c, u) = self.vectors(scene);
        let mut grid = Vtu::new(&self.points, &self.cells).point_data("u", c, &u[..]);
        if let Some(contact) = &contact {
            grid = contact.on(grid);
        }
        let by_cell =
            |f: fn(&CellStress) -> f64| -> Vec<f64> { self.cell_stress.iter().map(f).collect() };
        let six = |f: fn(&NodeStress) -> [f64; 6]| -> Vec<f64> {
            self.stress.iter().flat_map(f).collect()
        };
        let (stress, strain) = (six(|s| s.stress), six(|s| s.strain));
        let principal = self.stress.iter().map(|s| principal_stresses(&s.stress));
        let principal: Vec<f64> = principal.flatten().collect();
        let von_mises = self.von_mises();
        let centre_von_mises = by_cell(CellStress::von_mises);
        let centre_pressure = by_cell(CellStress::pressure);
        let centre = self.cell_stress.iter();
        let centre: Vec<f64> = centre.flat_map(|s| components(&s.stress)).collect();
        grid = if scene.form.is_elastic() {
            grid.point_data("stress", 6, &stress[..])
                .point_data("strain", 6, &strain[..])
                .point_data("von_mises", 1, &von_mises[..])
                .point_data("principal_stress", 3, &principal[..])
                .cell_data("young", 1, &self.rho[..])
                .cell_data("poisson", 1, &self.poisson[..])
                .cell_data("von_mises", 1, &centre_von_mises[..])
                .cell_data("pressure", 1, &centre_pressure[..])
                .cell_data("stress", 6, &centre[..])
        } else {
            grid.cell_data("rho", 1, &self.rho[..])
        };
        grid = grid
            .cell_data("body", 1, &body[..])
            .cell_data("subdomain", 1, &subdomain[..])
            .cell_data("rank", 1, &rank[..]);
        write(&grid)
    }

    /// Multiplier, gap, contact and friction at the points.
    fn contact_fields(&self, scene: &Scene, shown: &ContactRows) -> Result<ContactFields> {
        let rows = shown.rows;
        let copies = self.copies(rows);
        let mut fields = ContactFields::new(self.points.len());
        if scene.has_pressure() {
            fields = fields.with_areas();
        }
        // The pieces of a grid have the same arrays.
        if scene.has_pressure() && scene.mortar_rows().any(|m| m.law.is_inequality()) {
            fields = fields.with_smoothed();
        }
        let (smoothed, _) = smoothed(scene, rows);
        let inequalities = rows.iter().zip(smoothed).filter(|(r, _)| r.is_inequality());
        for (row, smoothed) in inequalities {
            for member in row.label.members.iter().flatten() {
                for &p in copies.get(member).into_iter().flatten() {
                    fields.add(p, row.multiplier, row.gap, row.holds())?;
                    if scene.has_pressure() {
                        fields.add_area(p, row.label.area)?;
                        fields.add_smoothed(p, smoothed * row.label.area);
                    }
                }
            }
        }
        if shown.friction {
            fields = fields.with_friction();
        }
        for node in friction::nodes(shown.tangential) {
            for (member, at) in node.on_bodies() {
                for &p in copies.get(&member).into_iter().flatten() {
                    fields.add_friction(p, &at);
                }
            }
        }
        fields.divide();
        Ok(fields)
    }

    /// u in VTK's form: a number, or three components.
    fn vectors(&self, scene: &Scene) -> (usize, Vec<f64>) {
        match scene.components() {
            1 => (1, self.u.clone()),
            c => {
                let three = |u: &[f64]| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)];
                (3, self.u.chunks_exact(c).flat_map(three).collect())
            }
        }
    }
}
