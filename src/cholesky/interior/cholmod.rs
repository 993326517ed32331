//! CHOLMOD behind the common face.

use std::sync::Arc;

use super::boundary::{held, split, Panel};
use super::condensation::{Condensation, Factor};
use super::order::Elimination;
use super::triangle::Triangle;
use super::{positive_diagonal, refused, Analysis, Keep, NoFactor, SparseCholesky};
use crate::linalg::csr::Csr;
use crate::linalg::dense::Dense;
use crate::petsc::{Cholmod, CholmodSymbolic, Refusal, Supernode, Upper};

/// The analysis of a pattern.
#[derive(Debug)]
pub struct OfCholmod {
    triangle: Arc<Triangle>,
    /// The pattern as C has it.
    ptr: Vec<i32>,
    row: Vec<i32>,
    symbolic: CholmodSymbolic,
}

impl OfCholmod {
    /// Supernodes where CHOLMOD thinks them worth it, or where an interface is to be found in them.
    pub fn new(k: &Csr, order: Elimination) -> Result<OfCholmod, NoFactor> {
        let triangle = Triangle::new(k, &order);
        let ptr: Vec<i32> = triangle.ptr.iter().map(|&p| p as i32).collect();
        let row: Vec<i32> = triangle.row.iter().map(|&i| i as i32).collect();
        let pattern = Upper {
            ptr: &ptr,
            row: &row,
        };
        let symbolic = CholmodSymbolic::new(pattern, !order.interface.is_empty())
            .map_err(|e| refused(e, &triangle.dofs, triangle.n_interior(), 0))?;
        Ok(OfCholmod {
            triangle: Arc::new(triangle),
            ptr,
            row,
            symbolic,
        })
    }

    fn numeric(&self, values: &[f64]) -> Result<Cholmod, NoFactor> {
        let pattern = Upper {
            ptr: &self.ptr,
            row: &self.row,
        };
        let triangle = &*self.triangle;
        let refuse = |e: Refusal| refused(e, &triangle.dofs, triangle.n_interior(), 0);
        self.symbolic.factor(pattern, values).map_err(refuse)
    }
}

impl Analysis for OfCholmod {
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor> {
        let triangle = &self.triangle;
        assert_eq!(triangle.n_interior(), k.n(), "an interface is kept");
        positive_diagonal(k, &triangle.dofs)?;
        let values = triangle.values(k);
        let l = self.numeric(&values)?;
        let diagonal = triangle.interior_diagonal(&values);
        held(diagonal, &l.diagonal(), &triangle.dofs)?;
        Ok(Box::new(CholmodFactor {
            triangle: triangle.clone(),
            l,
        }))
    }

    fn condense(&self, k: &Csr, keep: Keep) -> Result<(Factor, Dense), NoFactor> {
        let triangle = &*self.triangle;
        if triangle.n_interior() == triangle.n() {
            return Ok(Condensation::of_all(k, self.factor(k)?));
        }
        positive_diagonal(k, &triangle.dofs[..triangle.n_interior()])?;
        let (values, shift) = triangle.shifted(k);
        let l = self.numeric(&values)?;
        let supernodes = l.supernodes();
        let panels: Vec<Panel> = supernodes.iter().map(panel).collect();
        let diagonal = triangle.interior_diagonal(&values);
        let (factor, s) = split(triangle, keep, diagonal, &shift, &panels)?;
        let interface = &triangle.dofs[triangle.n_interior()..];
        Ok((Factor::new(k, interface, factor, keep), s))
    }
}

fn panel<'a>(s: &Supernode<'a>) -> Panel<'a> {
    Panel {
        start: s.start,
        width: s.width,
        below: s.rows[s.width..].iter().map(|&r| r as u32).collect(),
        values: s.values,
    }
}

/// L.
#[derive(Debug)]
struct CholmodFactor {
    triangle: Arc<Triangle>,
    l: Cholmod,
}

impl SparseCholesky for CholmodFactor {
    fn solve(&self, x: &mut [f64]) {
        self.triangle.solve(x, |b| self.l.solve(b));
    }

    fn solve_many(&self, x: &mut [Vec<f64>]) {
        self.triangle.solve_many(x, |b| self.l.solve(b));
    }

    fn bytes(&self) -> usize {
        self.l.bytes()
    }
}
