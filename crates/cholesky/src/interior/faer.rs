//! faer's sparse Cholesky factorisation, always sequential: subdomains are the unit of parallel work.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltParams, LltRegularization};
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef, CholeskySymbolicParams, LltRef,
    SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Auto, Conj, MatMut, Par, Side};

use super::analysis::{Analysis, NoFactor};
use super::boundary::{held, split, Panel};
use super::factor::{Condensation, Factor, SparseCholesky};
use super::order::Elimination;
use super::triangle::Triangle;
use crate::multifrontal::SingularInterior;
use crate::symbolic::{analysed, Keep};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

/// The analysis of a pattern.
#[derive(Debug)]
pub struct Faer {
    triangle: Arc<Triangle>,
    symbolic: Arc<SymbolicCholesky<u32>>,
}

impl Faer {
    /// Chooses supernodes where the number of operations is worth it, or where S has to be read off the factor.
    pub fn new(k: &Csr, order: Elimination) -> Result<Faer, NoFactor> {
        analysed();
        let triangle = Triangle::new(k, &order);
        let threshold = if order.interface.is_empty() {
            SupernodalThreshold::AUTO
        } else {
            SupernodalThreshold::FORCE_SUPERNODAL
        };
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: threshold,
            ..Default::default()
        };
        let ordered = SymmetricOrdering::Identity;
        let symbolic =
            factorize_symbolic_cholesky(pattern(&triangle), Side::Upper, ordered, params)
                .map_err(|e| NoFactor::Failed(format!("faer failed at the analysis ({e:?})")))?;
        Ok(Faer {
            triangle: Arc::new(triangle),
            symbolic: Arc::new(symbolic),
        })
    }

    /// The entries of L in faer's layout.
    fn numeric(&self, values: &[f64]) -> Result<Vec<f64>, NoFactor> {
        let (triangle, symbolic) = (&*self.triangle, &*self.symbolic);
        let mut l = vec![0.0; symbolic.len_val()];
        let params = <LltParams as Auto<f64>>::auto().into();
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, params);
        let mut buffer = MemBuffer::new(scratch);
        let done = symbolic.factorize_numeric_llt(
            &mut l,
            SparseColMatRef::new(pattern(triangle), values),
            Side::Upper,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut buffer),
            params,
        );
        match done {
            Ok(_) => Ok(l),
            Err(LltError::NonPositivePivot { index }) => {
                // The simplicial factorisation counts columns from one.
                let column = match symbolic.raw() {
                    SymbolicCholeskyRaw::Simplicial(_) => index - 1,
                    SymbolicCholeskyRaw::Supernodal(_) => index,
                };
                let dof = triangle.dofs[column];
                Err(match column < triangle.n_interior() {
                    true => SingularInterior { dof }.into(),
                    false => NoFactor::Indefinite(dof),
                })
            }
        }
    }

    fn pivots(&self, l: &[f64]) -> Vec<f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = &symbolic.col_ptr()[..symbolic.ncols()];
                starts.iter().map(|&p| l[p as usize]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::<u32, f64>::new(symbolic, l);
                let of = |s| {
                    let block = factor.supernode(s).val();
                    (0..block.ncols()).map(move |j| block[(j, j)])
                };
                (0..symbolic.n_supernodes()).flat_map(of).collect()
            }
        }
    }
}

fn pattern(triangle: &Triangle) -> SymbolicSparseColMatRef<'_, u32> {
    let n = triangle.n();
    SymbolicSparseColMatRef::new_checked(n, n, &triangle.ptr, None, &triangle.row)
}

impl Analysis for Faer {
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor> {
        assert_eq!(self.triangle.n_interior(), k.n(), "an interface is kept");
        positive_diagonal(k, &self.triangle.dofs)?;
        let values = self.triangle.values(k);
        let l = self.numeric(&values)?;
        let diagonal = self.triangle.interior_diagonal(&values);
        held(diagonal, &self.pivots(&l), &self.triangle.dofs)?;
        Ok(Box::new(FaerFactor {
            triangle: self.triangle.clone(),
            symbolic: self.symbolic.clone(),
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
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("supernodes were asked for");
        };
        let starts = symbolic.col_ptr_for_val();
        let panel = |s: usize| {
            let (start, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
            Panel {
                start: start as usize,
                width: (end - start) as usize,
                below: symbolic.supernode(s).pattern(),
                values: &l[starts[s] as usize..starts[s + 1] as usize],
            }
        };
        let panels: Vec<Panel> = (0..symbolic.n_supernodes()).map(panel).collect();
        let diagonal = triangle.interior_diagonal(&values);
        let (factor, s) = split(triangle, keep, diagonal, &shift, &panels)?;
        let interface = &triangle.dofs[triangle.n_interior()..];
        Ok((Factor::new(k, interface, factor, keep), s))
    }
}

/// Refuses a diagonal entry that is not positive: no pivot can be positive there. The test comes before faer, which
/// does not report NaN as an error.
fn positive_diagonal(k: &Csr, interior: &[u32]) -> Result<(), SingularInterior> {
    let positive = |&i: &u32| {
        let d = k.get(i as usize, i as usize);
        d > 0.0 && d.is_finite()
    };
    match interior.iter().find(|i| !positive(i)) {
        Some(&dof) => Err(SingularInterior { dof }),
        None => Ok(()),
    }
}

/// L.
#[derive(Debug)]
struct FaerFactor {
    triangle: Arc<Triangle>,
    symbolic: Arc<SymbolicCholesky<u32>>,
    l: Vec<f64>,
}

impl FaerFactor {
    fn solve_ordered(&self, b: &mut [f64]) {
        let n = self.triangle.n();
        let columns = b.len() / n;
        let scratch = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut buffer = MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.l).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b, n, columns),
            Par::Seq,
            MemStack::new(&mut buffer),
        );
    }
}

impl SparseCholesky for FaerFactor {
    fn solve(&self, x: &mut [f64]) {
        if !x.is_empty() {
            self.triangle.solve(x, |b| self.solve_ordered(b));
        }
    }

    fn solve_many(&self, x: &mut [Vec<f64>]) {
        self.triangle.solve_many(x, |b| self.solve_ordered(b));
    }

    fn bytes(&self) -> usize {
        let indices = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(s) => s.row_idx().len() + s.col_ptr().len(),
            SymbolicCholeskyRaw::Supernodal(s) => s.row_idx().len() + 3 * s.n_supernodes(),
        };
        std::mem::size_of_val(&self.l[..]) + 4 * indices
    }
}
