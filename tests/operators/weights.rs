//! Unit tests of `src/feti/jump/weights.rs`.

use fetifeti::inside::weights::*;
use fetifeti::settings::Scaling;
use scene::Scene;

fn noisy(rho: &str) -> Vec<bool> {
    let text = format!(
        "title = \"field\"\n[grid]\nbodies = 1\nsubdomains = 2\n\
         elements_per_subdomain = 24\nload = 1\nrho = \"{rho}\"\n"
    );
    let scene = Scene::parse("field.toml", &text).expect("a scene");
    let problem = scene.substructures(&|_| true).expect("substructures");
    problem.local.iter().map(is_noise).collect()
}

#[test]
fn noise_is_told_from_fields_and_channels() {
    let draw = "mod(43758.5453*sin(12.9898*48*x + 78.233*48*y), 1)";
    assert_eq!(noisy(&format!("10^(2*{draw} - 1)")), [true; 4]);
    // Too rough, smooth, constant, channels of four elements.
    assert_eq!(noisy(&format!("10^(8*{draw} - 4)")), [false; 4]);
    assert_eq!(noisy("10^(x + y)"), [false; 4]);
    assert_eq!(noisy("1 + 20*si + 3*sj + x"), [false; 4]);
    assert_eq!(noisy("2"), [false; 4]);
    assert_eq!(noisy("1 + 99*(mod(6*y, 1) < 0.5)"), [false; 4]);
    // Waves of eight elements: steep, but between their neighbours.
    assert_eq!(noisy("10^sin(37.7*x)"), [false; 4]);
}

#[test]
fn weights_of_noise_are_the_mean() {
    let draw = "mod(43758.5453*sin(12.9898*48*x + 78.233*48*y), 1)";
    let text = format!(
        "title = \"field\"\n[grid]\nbodies = 1\nsubdomains = 1\n\
         elements_per_subdomain = 24\nload = 1\nrho = \"2 + {draw}\"\n"
    );
    let scene = Scene::parse("field.toml", &text).expect("a scene");
    let problem = scene.substructures(&|_| true).expect("substructures");
    let d = &weights(&problem, Scaling::Rho, 1.0)[0];
    let mean = problem.local[0].rho.iter().sum::<f64>() / d.len() as f64;
    assert!(d.iter().all(|d| (d - mean).abs() < 1e-14 * mean));
    assert!((1.5..3.0).contains(&mean));
    let root = &weights(&problem, Scaling::Rho, 0.5)[0];
    assert!(root.iter().all(|d| (d - mean.sqrt()).abs() < 1e-14 * mean));
}
