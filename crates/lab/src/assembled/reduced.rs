//! Tᵀ K T of changing active sets, as one matrix of fixed size and pattern.
//!
//! An unknown that is not the lowest of its group, or whose group is tied to ground, keeps a row with a diagonal entry
//! alone and has the value zero. Only rows at the unknowns in inequalities, and at their neighbours, ever change. The
//! pattern has room for all sets, so that a direct solver analyses it once.

use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

use super::groups::ActiveGroups;
use super::near::NearKernel;
use super::rows::Inequalities;
use super::system::AssembledSystem;
use super::unknowns::Trace;
use base::Result;
use parallel::exchange::sum_all;
use petsc::{Comm, Mat, MatFlag, PetscInt, Scatter, Session, Vec as PetscVec};

/// A row of K.
struct KRow {
    row: PetscInt,
    cols: Vec<PetscInt>,
    vals: Vec<f64>,
}

/// The equality-constrained problems of one scene. Vectors u and v have one entry per unknown of the scene.
pub struct Reduced {
    session: Session,
    /// Tᵀ K T.
    pub a: Mat,
    /// Access to the entries at the unknowns in rows.
    pub trace: Trace,
    /// The norm that residuals are relative to; 0: not known yet.
    reference: f64,
    f: PetscVec,
    /// The unknowns in rows.
    unknowns: Vec<PetscInt>,
    /// Rows of K on this rank that change with the set: (index among the unknowns in rows, row).
    touched: Vec<(Option<usize>, KRow)>,
    /// The columns of those rows, and the plan that communicates u there.
    near: Vec<PetscInt>,
    scatter: Scatter,
    near_u: PetscVec,
    /// The rigid motions for the preconditioner.
    kernel: NearKernel,
}

impl Reduced {
    /// Takes K (assembled) and the rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        session: &Session,
        system: &AssembledSystem,
        rows: &Inequalities,
        kernel: NearKernel,
    ) -> Result<Reduced> {
        let unknowns: Vec<PetscInt> = rows.unknowns.iter().map(|&u| u as PetscInt).collect();
        let trace = Trace::new(rows, &system.b);
        let range = system.a.ownership_range()?;
        let index = |g: PetscInt| unknowns.binary_search(&g).ok();
        let mut touched = Vec::new();
        let mut all = Vec::with_capacity(range.len());
        for row in range.clone() {
            let (cols, vals) = system.a.row(row)?;
            let row = row as PetscInt;
            if cols.iter().any(|&c| index(c).is_some()) {
                touched.push((
                    index(row),
                    KRow {
                        row,
                        cols: cols.clone(),
                        vals: vals.clone(),
                    },
                ));
            }
            let own = cols.iter().filter(|&&c| range.contains(&(c as usize)));
            let own = own.count();
            all.push([own as PetscInt, (cols.len() - own) as PetscInt]);
        }
        // Without inequalities there is one set only, and its matrix is K.
        let a = match rows.len() {
            0 => system.a.clone(),
            _ => pattern(session, system, rows, &trace, &touched, &all)?,
        };
        let mut near: Vec<PetscInt> = touched.iter().flat_map(|(_, r)| r.cols.clone()).collect();
        near.sort_unstable();
        near.dedup();
        let near_u = PetscVec::seq(session, near.len())?;
        Ok(Reduced {
            session: session.clone(),
            a,
            trace,
            reference: system.reference,
            scatter: Scatter::new(&system.b, &near, &near_u)?,
            f: system.b.clone(),
            unknowns,
            touched,
            near,
            near_u,
            kernel,
        })
    }

    /// A vector of zeros.
    ///
    /// # Errors
    /// PETSc's.
    pub fn vector(&self) -> Result<PetscVec> {
        self.f.duplicate()
    }

    /// Replaces the load, and the norm that residuals are relative to.
    pub fn set_load(&mut self, f: &PetscVec, reference: f64) {
        (self.f, self.reference) = (f.clone(), reference);
    }

    fn comm(&self) -> &SimpleCommunicator {
        self.session.comm()
    }

    /// Puts Tᵀ K T into the matrix, with further entries at the lowest unknowns of groups. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn update(&self, groups: &ActiveGroups, entries: &[(usize, usize, f64)]) -> Result<()> {
        let mine: Vec<PetscInt> = self.touched.iter().map(|(_, row)| row.row).collect();
        self.a.zero_rows(&mine)?;
        // The lowest unknown of the group of this one.
        let lead = |g: PetscInt| match self.unknowns.binary_search(&g) {
            Ok(k) => groups.lead[k].map(|lead| self.unknowns[lead]),
            Err(_) => Some(g),
        };
        for (k, row) in &self.touched {
            if k.is_some_and(|k| !groups.is_free(k)) {
                let diagonal = row.cols.binary_search(&row.row).map(|i| row.vals[i]);
                let diagonal = diagonal.unwrap_or(1.0);
                self.a.add_values(&[row.row], &[row.row], &[diagonal])?;
            }
            let Some(to) = lead(row.row) else { continue };
            let entries = row.cols.iter().zip(&row.vals);
            let (cols, vals): (Vec<PetscInt>, Vec<f64>) = entries
                .filter_map(|(&c, &v)| lead(c).map(|c| (c, v)))
                .unzip();
            self.a.add_values(&[to], &cols, &vals)?;
        }
        self.add(entries)?;
        // The row of an unknown that is not the lowest of its group has only its diagonal.
        self.kernel.attach_where(&self.a, |x| {
            let free = |k: usize, v: f64| if groups.is_free(k) { v } else { 0.0 };
            let at = self.trace.get(self.comm(), x)?;
            let kept: Vec<f64> = at.iter().enumerate().map(|(k, v)| free(k, *v)).collect();
            self.trace.set(x, &kept)
        })
    }

    /// Adds entries (k, l, value) to the matrix, where k and l are indices of unknowns that rows may join, and sends
    /// all that was added to its place. Collective.
    fn add(&self, entries: &[(usize, usize, f64)]) -> Result<()> {
        let mut mine = vec![false; self.unknowns.len()];
        self.trace.mine().iter().for_each(|&(k, _)| mine[k] = true);
        for &(k, l, value) in entries.iter().filter(|(k, ..)| mine[*k]) {
            let [row, col] = [k, l].map(|k| self.unknowns[k]);
            self.a.add_values(&[row], &[col], &[value])?;
        }
        self.a.assemble()
    }

    /// The diagonal of K at the unknowns in rows. Collective.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns.len()];
        for (k, row) in &self.touched {
            if let (Some(k), Ok(i)) = (k, row.cols.binary_search(&row.row)) {
                out[*k] = row.vals[i];
            }
        }
        sum_all(self.comm(), &mut out);
        out
    }

    /// Whether the preconditioner is given rigid motions, which change with the set.
    pub fn has_near_kernel(&self) -> bool {
        !self.kernel.is_empty()
    }

    /// Tᵀ(f − K u₀ − y), where y are forces at the unknowns in rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn rhs(&self, groups: &ActiveGroups, forces: &[f64]) -> Result<PetscVec> {
        let b = self.vector()?;
        b.copy_from(&self.f)?;
        let mut led = vec![0.0; self.unknowns.len()];
        {
            let mut b = b.array_mut()?;
            let start = self.f.ownership_range().start;
            for (k, row) in &self.touched {
                let given = row.cols.iter().zip(&row.vals).map(|(&c, v)| {
                    let place = self.unknowns.binary_search(&c);
                    place.map_or(0.0, |k| v * groups.offset[k])
                });
                let b = &mut b[row.row as usize - start];
                *b -= given.sum::<f64>();
                if let Some(k) = k {
                    led[*k] = *b;
                }
            }
        }
        sum_all(self.comm(), &mut led);
        led.iter_mut().zip(forces).for_each(|(b, y)| *b -= y);
        self.trace.set(&b, &groups.fold(&led))?;
        Ok(b)
    }

    /// f − K u at the unknowns in rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn forces(&self, u: &PetscVec) -> Result<Vec<f64>> {
        self.scatter.forward(u, &self.near_u)?;
        let (near, f) = (self.near_u.array()?, self.f.array()?);
        let start = self.f.ownership_range().start;
        let mut out = vec![0.0; self.unknowns.len()];
        for (k, row) in &self.touched {
            let Some(k) = k else { continue };
            let at = |c: PetscInt| near[self.near.binary_search(&c).expect("columns were listed")];
            let ku = row.cols.iter().zip(&row.vals).map(|(&c, v)| v * at(c));
            out[*k] = f[row.row as usize - start] - ku.sum::<f64>();
        }
        sum_all(self.comm(), &mut out);
        Ok(out)
    }

    /// The initial v: the one whose u is nearest, zero at unknowns that are not the lowest of their group. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn start(&self, groups: &ActiveGroups, u: &PetscVec) -> Result<PetscVec> {
        let v = self.vector()?;
        v.copy_from(u)?;
        let at = self.trace.get(self.comm(), u)?;
        self.trace
            .set(&v, &groups.nearest(&at, &vec![1.0; at.len()]))?;
        Ok(v)
    }

    /// ‖f‖₂, or without a load the norm of the right-hand side `b`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn reference(&self, b: &PetscVec) -> Result<f64> {
        match self.reference {
            reference if reference > 0.0 => Ok(reference),
            _ => b.norm2(),
        }
    }
}

/// The matrix with room for all sets: rows of K that no set changes, and zeros in the others. Collective.
fn pattern(
    session: &Session,
    system: &AssembledSystem,
    rows: &Inequalities,
    trace: &Trace,
    touched: &[(Option<usize>, KRow)],
    lengths: &[[PetscInt; 2]],
) -> Result<Mat> {
    let unknowns: Vec<PetscInt> = rows.unknowns.iter().map(|&u| u as PetscInt).collect();
    let index = |g: PetscInt| unknowns.binary_search(&g).ok();
    let partners = rows.lower_partners();
    let room = Room::new(session.comm(), &partners, trace, lengths);
    let (n, range) = (system.a.size()?.0, system.a.ownership_range()?);
    let couples = couples(rows, &partners);
    let mut d: Vec<PetscInt> = lengths.iter().map(|r| r[0]).collect();
    let mut o: Vec<PetscInt> = lengths.iter().map(|r| r[1]).collect();
    for (k, row) in touched {
        let i = row.row as usize - range.start;
        let springs = k.map_or(0, |k| couples.get(&k).map_or(0, Vec::len));
        let most = room.of(*k, row.cols.len()) + springs;
        d[i] = most.min(range.len()) as PetscInt;
        o[i] = most.min(n - range.len()) as PetscInt;
    }
    let a = Mat::preallocated(session, Comm::World, range.len(), range.len(), &d, &o)?;
    // The columns in which a row may get entries: those of K, and the lowest unknowns of their groups.
    for (k, row) in touched {
        let mut cols: Vec<PetscInt> = Vec::new();
        for &c in &row.cols {
            match index(c) {
                Some(j) => cols.extend(partners[j].iter().map(|&p| unknowns[p])),
                None => cols.push(c),
            }
        }
        cols.sort_unstable();
        cols.dedup();
        let zeros = vec![0.0; cols.len()];
        match k {
            Some(k) => {
                for &p in &partners[*k] {
                    a.add_values(&[unknowns[p]], &cols, &zeros)?;
                }
            }
            None => a.add_values(&[row.row], &cols, &zeros)?,
        }
    }
    for &(k, _) in trace.mine() {
        let cols: Vec<PetscInt> = couples
            .get(&k)
            .into_iter()
            .flatten()
            .map(|&l| unknowns[l])
            .collect();
        a.add_values(&[unknowns[k]], &cols, &vec![0.0; cols.len()])?;
    }
    let mut next = touched.iter().map(|(_, row)| row.row).peekable();
    for row in range {
        if next.next_if_eq(&(row as PetscInt)).is_none() {
            let (cols, vals) = system.a.row(row)?;
            a.add_values(&[row as PetscInt], &cols, &vals)?;
        }
    }
    a.assemble()?;
    a.set_flag(MatFlag::Spd)?;
    Ok(a)
}

/// The unknowns that springs across slips couple with each one, which the matrix may leave apart.
fn couples(rows: &Inequalities, partners: &[Vec<usize>]) -> BTreeMap<usize, Vec<usize>> {
    let mut out: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for node in rows
        .friction
        .iter()
        .filter(|node| node.tangential.len() == 2)
    {
        let ends = node
            .tangential
            .iter()
            .flat_map(|&t| [rows.rows[t].plus, rows.rows[t].minus]);
        let ends = ends.filter(|&end| end < rows.ground());
        let mut all: Vec<usize> = ends.flat_map(|end| partners[end].iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        for &k in &all {
            out.entry(k).or_default().extend(&all);
        }
    }
    for list in out.values_mut() {
        list.sort_unstable();
        list.dedup();
    }
    out
}

/// Bounds for the number of entries of a row that changes.
struct Room {
    /// For each unknown, the entries of all rows of K that may be added to its row.
    sum: Vec<usize>,
    /// Largest possible number of unknowns in a group.
    most: usize,
}

impl Room {
    fn new(
        comm: &SimpleCommunicator,
        partners: &[Vec<usize>],
        trace: &Trace,
        lengths: &[[PetscInt; 2]],
    ) -> Room {
        let mut length = vec![0.0; partners.len()];
        for &(k, i) in trace.mine() {
            length[k] = (lengths[i][0] + lengths[i][1]) as f64;
        }
        sum_all(comm, &mut length);
        let mut sum = vec![0; partners.len()];
        for (k, list) in partners.iter().enumerate() {
            list.iter().for_each(|&p| sum[p] += length[k] as usize);
        }
        Room {
            sum,
            most: partners.iter().map(Vec::len).max().unwrap_or(1),
        }
    }

    fn of(&self, k: Option<usize>, length: usize) -> usize {
        self.most * k.map_or(length, |k| self.sum[k])
    }
}
