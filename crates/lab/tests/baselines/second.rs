//! Unit tests of `crates/lab/src/baselines/second.rs`.

use super::*;
use scene::Scene;

#[test]
fn the_factor_stays_positive_and_changes_across_the_scene() {
    let scene = Scene::parse(
        "s.toml",
        "[grid]\nbodies = 2\nelements = 2\nsize = [4, 2]\norigin = [1, 1]\n",
    )
    .expect("a scene");
    let load = SecondLoad::new(&UnknownLayout::new(&scene));
    let [low, mid, high] =
        [[1.0, 3.0, 0.0], [3.0, 2.0, 0.0], [5.0, 1.0, 0.0]].map(|x| load.value(x));
    assert_eq!(mid, 1.0);
    assert!(
        low > 0.5 && low < 0.9 && high > 1.1 && high < 1.5,
        "{low} {high}"
    );
}
