//! What the program says of itself.

/// What `fetifeti --help` prints.
pub const USAGE: &str = "\
fetifeti: the FETI-FETI method for bodies in contact, on PETSc

  fetifeti solve SCENE [--out DIR] [--json FILE] [--quiet] [PETSc options]
      solve a scene; write solution.vtu, solution.png and report.json to DIR
  fetifeti solve SCENE [--checkpoint FILE] [--resume FILE] ...
      write the state of the contact loop to FILE after every step; go on from such a file, on any number of ranks
  fetifeti plan SCENE
      validate a scene; say what the solver will build and why, with sizes and memory
  fetifeti compare SCENE [--with bddc,fetidp,gamg,hypre,mumps] [--json FILE] [--out DIR] [--quiet] [PETSc options]
      the same problem through PETSc's solvers, to the same relative residual; their options have the prefixes
      -bddc_ -fetidp_ -gamg_ -hypre_ -mumps_; -compare_cores N, -compare_time_limit SECONDS for each method
  fetifeti bench [CASE|SCENE ...] [--rounds N] [--with LIST] [--quick] [--json FILE] [--out DIR] [--quiet] [PETSc options]
      the methods of compare in turns, N times each (default 5): medians, smallest and largest seconds beside errors;
      table, JSON, CSV and picture; without a case all of them, fetifeti bench --list says which; --quick: small ones
  fetifeti table1 [--rows N,N,N ...] [--json FILE] [--out DIR] [--quiet] [PETSc options]
      Table 1 and Figure 3 of Lee (2010) beside ours
  fetifeti study adaptive|hertz|hard-cases|kappa|kernels|scaling|speed-error [CASE] [--json FILE] [--out DIR] [--quick] [--quiet] [PETSc options]
      hertz: contact half-width and peak pressure against Hertz's theory; hard-cases: problems that are
      hard for the method against direct solutions, exit code 1 where an answer is wrong; kappa: condition
      numbers with M_D and M_C over H_b/H_s and H_s/h (-fetifeti_spectrum: exact ones too); kernels: local
      solvers and orderings against each other; scaling: seconds over ranks and bodies by phase, messages,
      and a model for up to 100 000 ranks of a network with -scaling_alpha SECONDS -scaling_beta
      SECONDS_PER_BYTE; speed-error: error against seconds, ours and the baselines of compare, over meshes
      and tolerances;
      --quick: coarser meshes, smaller cases, a few seconds
  mpirun -n N fetifeti solve SCENE ...
      the same answer on N ranks

A FILE of - is standard output. PETSc options have one dash (-fetifeti_ksp_rtol 1e-10 -fetifeti_ksp_monitor);
fetifeti -help lists ours with PETSc's. They are also read from PETSC_OPTIONS and -options_file.
Exit codes: 0 solved, 1 not converged (partial results written), 2 bad input, 3 the environment.
";
