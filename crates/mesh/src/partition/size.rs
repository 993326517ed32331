//! How many subdomains.

/// Unknowns of a subdomain in the plane and in space. With fewer, the coarse problem and the interface grow. With more,
/// factorisations and dense Schur complements become dear: in space their work grows as the square of the unknowns.
/// In space 1400 to 3000 are equally good for large meshes, and 2000 are better than 1000 for small ones; in the plane
/// 2500 are better than 5000 (docs/meshes.md, "Subdomains").
const UNKNOWNS: [usize; 2] = [2500, 2000];

/// The number of subdomains for a body of so many unknowns, at least one.
///
/// # Panics
/// When `dim` is not 2 or 3.
pub fn subdomains_for(unknowns: usize, dim: usize) -> usize {
    let each = match dim {
        2 => UNKNOWNS[0],
        3 => UNKNOWNS[1],
        _ => panic!("a dimension of {dim}, expected 2 or 3"),
    };
    // Rounded to the nearest.
    ((unknowns + each / 2) / each).max(1)
}
