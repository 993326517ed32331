//! Unit tests of `crates/lab/src/study/scaling/scenes.rs`.

use super::*;
use scene::Scene;

#[test]
fn scenes_have_the_counts_that_they_are_named_after() {
    for quick in [true, false] {
        let all = setups(quick);
        let largest = all.iter().map(|s| s.n_bodies() * s.subdomains.pow(2)).max();
        assert_eq!(largest, Some(if quick { 256 } else { 4096 }));
        for setup in all.iter().filter(|s| s.n_bodies() * s.subdomains < 100) {
            let scene = Scene::parse("test.toml", &setup.scene()).expect("a scene");
            assert_eq!(scene.n_bodies(), setup.n_bodies(), "{}", setup.name());
            let subdomains = setup.n_bodies() * setup.subdomains.pow(2);
            assert_eq!(scene.n_subdomains(), subdomains, "{}", setup.name());
            assert_eq!(
                scene.has_contact(),
                setup.problem == ScalingProblem::Contact
            );
        }
    }
}
