/// Version of the binary interfaces: the number behind `libfetifeti.so.` and `libfetifeti_step.so.`. It grows when a
/// program that was linked with an earlier library can no longer use this one.
pub const ABI: u32 = 0;

/// Gives the shared library `libSTEM.so` of this package the name that programs ask the loader for, with the version of
/// its interface. Cargo writes libSTEM.so; links beside it let programs that are linked with that file run.
fn name_the_library(stem: &str) {
    let file = format!("lib{stem}.so");
    let name = format!("{file}.{ABI}");
    // Not rustc-cdylib-link-arg: cargo passes that on to every library of a package that depends on this one, and the
    // last name counts. Executables of this package have the name, too, where it means nothing.
    println!("cargo:rustc-link-arg=-Wl,-soname,{name}");
    let out = std::path::PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    // target/PROFILE/build/PACKAGE-HASH/out
    let Some(profile) = out.ancestors().nth(3) else {
        return;
    };
    for dir in [profile.to_path_buf(), profile.join("deps")] {
        let link = dir.join(&name);
        if dir.is_dir() && !link.exists() {
            let _ = std::fs::remove_file(&link);
            if let Err(e) = std::os::unix::fs::symlink(&file, &link) {
                println!("cargo:warning={} cannot be made: {e}", link.display());
            }
        }
    }
}
