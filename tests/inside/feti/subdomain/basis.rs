//! Unit tests of `src/feti/subdomain/basis.rs`.

use super::*;
use crate::matrices::random;

fn averages(lists: &[&[usize]]) -> Basis {
    let mut basis = Basis::default();
    lists.iter().for_each(|l| basis.push_mean(l.to_vec()));
    basis
}

#[test]
fn the_reflection_is_its_own_inverse_and_shows_the_average() {
    let lists: [&[usize]; 3] = [&[1, 4, 6], &[5], &[2, 3]];
    let basis = averages(&lists);
    let u = random(8, 3);
    let mut h = u.clone();
    basis.to_coordinates(&mut h);
    for (k, pivot) in basis.pivots().into_iter().enumerate() {
        let mean = lists[k].iter().map(|&i| u[i]).sum::<f64>() / lists[k].len() as f64;
        assert!((h[pivot] - basis.factor(k) * mean).abs() < 1e-15);
        assert!((basis.values(&u)[k] - mean).abs() < 1e-15);
    }
    assert_eq!((h[0], h[5], h[7]), (u[0], u[5], u[7]));
    basis.to_nodes(&mut h);
    assert!(h.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-15));
}

#[test]
fn functionals_on_top_of_averages_become_coordinates() {
    let mut basis = averages(&[&[1, 4, 6], &[2, 3]]);
    let class = vec![1, 2, 3, 4, 6, 7];
    // Two functionals with entries over many decades, and a sum of earlier ones.
    let c = [
        [1e8, 1.0, -2.0, 3.0, 1e-3, 1.0],
        [1e8, 1.0, 5.0, 3.0, 2.0, -1.0],
    ];
    assert!(basis.push(class.clone(), &c[0]));
    assert!(basis.push(class.clone(), &c[1]));
    let sum = [1e8 + 1.0, 1.5, -1.5, 4.0, 1e-3 + 1.0, 1.0];
    assert!(!basis.push(class.clone(), &sum));
    assert_eq!(basis.len(), 4);

    let u = random(8, 3);
    let mut h = u.clone();
    basis.to_coordinates(&mut h);
    let vectors = basis.vectors(8);
    for (k, pivot) in basis.pivots().into_iter().enumerate() {
        let dot = |q: &[f64]| q.iter().zip(&u).map(|(q, u)| q * u).sum::<f64>();
        assert!((h[pivot] - dot(&vectors[k])).abs() < 1e-14);
    }
    // The remaining part has no average, and c vanishes on it.
    let mut left = u.clone();
    basis.remove(&mut left);
    assert!((left[1] + left[4] + left[6]).abs() < 1e-14);
    assert!((left[2] + left[3]).abs() < 1e-14);
    for c in &c {
        let sum: f64 = class.iter().zip(c).map(|(&i, c)| c * left[i]).sum();
        assert!(sum.abs() < 1e-6, "{sum}");
    }
    basis.set_values(&basis.values(&u), &mut left);
    assert!(left.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-14));

    let mut a = Dense::zeros(8, 8);
    a.data.copy_from_slice(&random(64, 9));
    let mut au = vec![0.0; 8];
    a.add_mul(&u, &mut au);
    basis.to_coordinates(&mut au);
    let before = a.clone();
    basis.congruence_to_coordinates(&mut a);
    let (mut hu, mut hau) = (u.clone(), vec![0.0; 8]);
    basis.to_coordinates(&mut hu);
    a.add_mul(&hu, &mut hau);
    assert!(au.iter().zip(&hau).all(|(x, y)| (x - y).abs() < 1e-14));
    basis.congruence_to_nodes(&mut a);
    let same = a.data.iter().zip(&before.data);
    assert!(same.clone().all(|(x, y)| (x - y).abs() < 1e-14));
}
