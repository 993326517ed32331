//! The command-line program.

#[global_allocator]
static HEAP: fetifeti::petsc::Heap = fetifeti::petsc::Heap;

fn main() {
    std::process::exit(fetifeti::cli::main())
}
