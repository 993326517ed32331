//! Unit tests of `src/feti/projector/refined.rs`.

use super::*;
use crate::feti::projector::gram_pattern::FactorSharing;
use crate::feti::projector::pattern::meeting;
use crate::feti::projector::products::transposed;
use crate::feti::projector::rows::KernelRows;
use crate::testing::with_session;

/// Bodies in a row, with two motions each: more motions than dense algebra is for.
const BODIES: usize = 100;

/// Rows between neighbours, and rows that hold every tenth body.
fn rows() -> KernelRows {
    let held = (0..2 * BODIES as u32).filter(|c| c % 20 < 2);
    let mut entries: Vec<_> = (0..).zip(held).map(|(row, c)| (row, c, 1.0)).collect();
    let mut row = entries.len() as u32;
    for a in 0..BODIES as u32 - 1 {
        for k in 0..3u32 {
            let t = f64::from((7 * a + 3 * k) % 11) / 11.0;
            let values = [1.0, t - 0.4, -1.0, 0.7 - t];
            entries.extend((0..4).map(|c| (row, 2 * a + c, values[c as usize])));
            row += 1;
        }
    }
    KernelRows::from_triplets(row as usize, entries)
}

/// GᵀDG with weights over four orders, and with every entry above the diagonal wrong by the part `skew`.
fn with_matrix(
    skew: f64,
    test: impl Fn(std::result::Result<RefinedFactor, Csr>, &Csr) + Send + Sync + 'static,
) {
    with_session(move |session| {
        let comm = session.comm();
        let g = rows();
        let start: Vec<usize> = (0..=BODIES).map(|b| 2 * b).collect();
        let shape = GramPattern::new(
            comm,
            &meeting(comm, &g, &g, &start),
            &start,
            &FactorSharing::any(),
        );
        let plain = Gram::new(&shape, shape.product(comm, &g, &g, |_| true));
        assert!(plain.is_sparse() && plain.dropped.is_empty());
        let mut weighted = g.clone();
        let weights: Vec<f64> = (0..g.n()).map(|i| 10f64.powi(i as i32 % 5 - 2)).collect();
        weighted.scale_rows(&weights);
        let mut a = shape.product(comm, &g, &weighted, |_| true);
        for i in 0..a.n() {
            for k in a.row_ptr[i]..a.row_ptr[i + 1] {
                if a.col[k] as usize > i {
                    a.val[k] *= 1.0 + skew;
                }
            }
        }
        let both = [a.clone(), transposed(&a)];
        test(RefinedFactor::weighted(&shape, both, &plain), &a);
    });
}

/// max |b − A x| / (max |A| max |x|) for A or its transpose.
fn residual(a: &Csr, x: &[f64], b: &[f64], side: InverseSide) -> f64 {
    let mut rest = b.to_vec();
    match side {
        InverseSide::Plain => a.add_mul(-1.0, x, &mut rest),
        InverseSide::Transposed => a.add_mul_transpose(-1.0, x, &mut rest),
    }
    let largest = |v: &[f64]| v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    largest(&rest) / (largest(&a.val) * largest(x))
}

fn solves(skew: f64, steps: std::ops::RangeInclusive<usize>) {
    with_matrix(skew, move |weighted, a| {
        let weighted = weighted.unwrap_or_else(|_| panic!("the factor is good enough"));
        assert!(steps.contains(&weighted.steps), "{} steps", weighted.steps);
        let b: Vec<f64> = (0..a.n()).map(|i| ((i * 31) % 17) as f64 - 8.0).collect();
        for side in [InverseSide::Plain, InverseSide::Transposed] {
            let mut x = b.clone();
            weighted.solve(&mut x, side);
            let residual = residual(a, &x, &b, side);
            assert!(residual < 1e-14, "{residual:e} with {skew:e}");
        }
    });
}

#[test]
fn a_symmetric_matrix_needs_no_steps() {
    solves(0.0, 0..=1);
}

/// Both sides are inverted as they are, not as their mean.
#[test]
fn steps_make_up_for_what_is_not_symmetric() {
    solves(1e-9, 1..=STEPS);
}

#[test]
fn what_steps_do_not_mend_is_given_back() {
    with_matrix(0.3, |weighted, a| {
        let back = weighted.err().expect("the symmetric part is no inverse");
        assert_eq!(back.val, a.val);
    });
}
