//! Unit tests of `crates/scene/src/checkpoint/mod.rs`.

use super::fingerprint;

#[test]
fn what_is_solved_tells_scenes_apart() {
    let text = "title = \"a\"\n[[body]]\nsize = 1\nload = [{ x = [0, 1], value = 2 }]\n";
    let same = "# other words\ntitle = 'b'\n[[body]]\nload = [ {value=2, x=[0,1]} ]\nsize=1\n\
                [options]\nfetifeti_ksp_rtol = 1e-9\n";
    let other = text.replace("value = 2", "value = 3");
    assert_eq!(fingerprint(text), fingerprint(same));
    assert_ne!(fingerprint(text), fingerprint(&other));
}
