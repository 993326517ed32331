//! Element matrices of bilinear squares and trilinear cubes by Gauss quadrature.

use super::Physics;

/// Stiffness of a cube of side h, dofs ordered by corner (x first), then component.
pub fn stiffness(dim: usize, h: f64, physics: Physics) -> Vec<Vec<f64>> {
    let comps = match physics {
        Physics::Scalar => 1,
        Physics::Elastic { .. } => dim,
    };
    let corners = 1usize << dim;
    let n = corners * comps;
    let mut k = vec![vec![0.0; n]; n];
    let gauss = [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()];
    let weight = (h / 2.0).powi(dim as i32);
    for q in 0..1usize << dim {
        let point: Vec<f64> = (0..dim).map(|d| gauss[q >> d & 1]).collect();
        let gradient: Vec<Vec<f64>> = (0..corners)
            .map(|a| {
                let factor = |d: usize| {
                    if a >> d & 1 == 1 {
                        point[d]
                    } else {
                        1.0 - point[d]
                    }
                };
                (0..dim)
                    .map(|d| {
                        let slope = if a >> d & 1 == 1 { 1.0 } else { -1.0 };
                        let others = (0..dim).filter(|&e| e != d).map(factor);
                        slope / h * others.product::<f64>()
                    })
                    .collect()
            })
            .collect();
        for a in 0..corners {
            for b in 0..corners {
                let (ga, gb) = (&gradient[a], &gradient[b]);
                let dot: f64 = ga.iter().zip(gb).map(|(x, y)| x * y).sum();
                match physics {
                    Physics::Scalar => k[a][b] += weight * dot,
                    Physics::Elastic { nu } => {
                        // λ div u div v + 2 μ ε(u) : ε(v)
                        let mu = 0.5 / (1.0 + nu);
                        let lambda = nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
                        for i in 0..dim {
                            for j in 0..dim {
                                let same = if i == j { dot } else { 0.0 };
                                let value = lambda * ga[i] * gb[j] + mu * (ga[j] * gb[i] + same);
                                k[a * dim + i][b * dim + j] += weight * value;
                            }
                        }
                    }
                }
            }
        }
    }
    k
}
