//! Bases of motions with few entries.

use crate::assembly::zero_energy::ZeroEnergyMode;

/// Displacements that count as none, beside motions of order one.
pub(super) const NONE: f64 = 1e-4;

/// A motion without what it has at `dofs`, where it vanishes but for rounding.
pub(super) fn less(mut motion: ZeroEnergyMode, dofs: &[u32]) -> ZeroEnergyMode {
    motion.retain(|e| dofs.binary_search(&e.0).is_err());
    motion
}

/// a − factor · b.
pub(super) fn minus(a: &ZeroEnergyMode, factor: f64, b: &ZeroEnergyMode) -> ZeroEnergyMode {
    let mut all = a.clone();
    all.extend(b.iter().map(|&(dof, v)| (dof, -factor * v)));
    all.sort_by_key(|e| e.0);
    let sums = all.chunk_by(|a, b| a.0 == b.0);
    let sums = sums.map(|s| (s[0].0, s.iter().map(|e| e.1).sum::<f64>()));
    sums.filter(|e| e.1.abs() > 1e-14).collect()
}

/// The displacement at a degree of freedom.
pub(super) fn at(motion: &ZeroEnergyMode, dof: u32) -> f64 {
    let found = motion.binary_search_by_key(&dof, |e| e.0);
    found.map_or(0.0, |i| motion[i].1)
}

/// A basis of the same space, each vector one at a degree of freedom of its own and zero at those of the others.
pub(super) fn dual(motions: Vec<ZeroEnergyMode>) -> Vec<(u32, ZeroEnergyMode)> {
    let mut out: Vec<(u32, ZeroEnergyMode)> = Vec::new();
    for motion in motions {
        let motion = without(motion, &out);
        let largest = motion.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some(&(hold, value)) = largest.filter(|e| e.1.abs() > NONE) else {
            continue;
        };
        let motion: ZeroEnergyMode = motion
            .into_iter()
            .map(|(dof, v)| (dof, v / value))
            .collect();
        for (_, other) in &mut out {
            let part = at(other, hold);
            if part != 0.0 {
                *other = minus(other, part, &motion);
            }
        }
        out.push((hold, motion));
    }
    out
}

/// A motion less those of a dual basis that are as large where the basis has its own degrees of freedom.
pub(super) fn without(
    mut motion: ZeroEnergyMode,
    basis: &[(u32, ZeroEnergyMode)],
) -> ZeroEnergyMode {
    for (hold, other) in basis {
        let part = at(&motion, *hold);
        if part != 0.0 {
            motion = minus(&motion, part, other);
        }
    }
    motion
}

/// An orthonormal basis of the same space.
pub(super) fn orthonormal(basis: &[(u32, ZeroEnergyMode)]) -> Vec<ZeroEnergyMode> {
    let dot = |a: &ZeroEnergyMode, b: &ZeroEnergyMode| -> f64 {
        a.iter().map(|e| e.1 * at(b, e.0)).sum()
    };
    let mut out: Vec<ZeroEnergyMode> = Vec::new();
    for (_, motion) in basis {
        let mut q = motion.clone();
        for _ in 0..2 {
            for known in &out {
                let part = dot(known, &q);
                if part != 0.0 {
                    q = minus(&q, part, known);
                }
            }
        }
        let length = dot(&q, &q).sqrt();
        q.iter_mut().for_each(|e| e.1 /= length);
        out.push(q);
    }
    out
}

#[cfg(test)]
#[path = "../../tests/idle/basis.rs"]
mod tests;
