/// Version of the binary interface: the number behind `libfetifeti.so.`. It grows when a program that was linked with
/// an earlier library can no longer use this one.
pub const ABI: u32 = 0;
