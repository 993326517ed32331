//! How many subdomains.

/// Unknowns of a subdomain in the plane and in space. With fewer, the coarse problem and the interface grow. With more,
/// factorisations and dense Schur complements become dear: in space their work grows as the square of the unknowns.
/// Measured with `bench`: the case `plate` takes 34 iterations with 1250 and with 2500 unknowns, 46 with 5000, 56 with
/// 10,000; a finer `rod-4` takes 22 s of processor time with 500 and with 1000, 27 s with 1500, 29 s with 2500.
const UNKNOWNS: [usize; 2] = [2500, 1000];

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
