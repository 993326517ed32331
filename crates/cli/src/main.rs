//! The command-line program.

#[global_allocator]
static HEAP: petsc::Heap = petsc::Heap;

fn main() {
    std::process::exit(fetifeti_cli::main())
}
