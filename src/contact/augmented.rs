//! A = Pᵀ (F + C) P + ϱ (I − P) on all candidate rows, and its preconditioner inside a face. C is the compliance of the
//! rows themselves, zero as a rule.
//!
//! The variables are x = S⁻¹ λ with S² = diag(B_D diag(K) B_Dᵀ), so that rows between stiff and soft bodies have the
//! same weight. Rows that are no candidates have S = 0. Let F be the rows that are free in a face, G_F the rows of G
//! there, N_F = G_FᵀG_F and P_F its projector. Then
//!
//! ```text
//!     z = P_F S⁻¹ M_F⁻¹ S⁻¹ P_F v + ϱ⁻¹ G_F N_F⁺ N N_F⁺ G_Fᵀ v
//! ```
//!
//! inverts A_FF up to the error of M_F⁻¹: on ker G_Fᵀ the operator is F alone, and the second term is the inverse of
//! the penalty on range G_F.

use std::rc::Rc;

use super::disc::Disc;
use super::force_balance::ForceBalance;
use super::friction::node::Node;
use super::modes::Face;
use super::mprgp::BoundedQuadratic;
use super::settings::ContactSettings;
use crate::feti::projector::rows::KernelRows;
use crate::feti::LinearMethod;
use crate::Result;
use parallel::exchange::total;
use petsc::Vec as PetscVec;

/// The operator of SMALBE's inner problems.
pub struct Augmented<'a> {
    method: &'a LinearMethod,
    /// S on the owned rows.
    pub scale: Vec<f64>,
    g: KernelRows,
    /// The balance of forces, all rows.
    pub balance: Rc<ForceBalance>,
    /// ϱ, which is also ‖A‖.
    pub rho: f64,
    precondition: bool,
    /// The face that was entered last.
    pub face: Face<'a>,
    /// The balance of forces in it.
    face_balance: Option<ForceBalance>,
    lambda: PetscVec,
    image: PetscVec,
}

impl<'a> Augmented<'a> {
    /// The operator on all candidate rows, all of which must hold in the dual operators now; `nodes` are those with
    /// friction. Collective.
    pub fn new(
        method: &'a LinearMethod,
        settings: &ContactSettings,
        nodes: &[Node],
    ) -> Result<Augmented<'a>> {
        let tuning = &settings.tuning;
        let comm = method.session.comm();
        let dual = method.dual();
        let (stiffness, natural) = (&dual.stiffness, &dual.natural);
        let mut diagonal = natural.superlumped(&method.problem, stiffness)?;
        // Where several bodies meet, B_D shares a jump among rows that depend on each other. Alone, each of them is as
        // stiff as its nodes.
        let give = stiffness.compliance_of_rows(&method.problem)?;
        for (d, c) in diagonal.iter_mut().zip(&give).filter(|(_, c)| **c > 0.0) {
            *d = 1.0 / c;
        }
        for (d, c) in diagonal.iter_mut().zip(&stiffness.jump.compliance) {
            *d /= 1.0 + *d * c;
        }
        // A disc stays round where both its rows have the same scale.
        for node in nodes {
            let least = node.tangential.iter().map(|&i| diagonal[i]);
            let least = least.fold(f64::INFINITY, f64::min);
            node.tangential.iter().for_each(|&i| diagonal[i] = least);
        }
        let scale: Vec<f64> = (0..diagonal.len())
            .map(|i| {
                if stiffness.jump.is_candidate(i) {
                    diagonal[i].sqrt()
                } else {
                    0.0
                }
            })
            .collect();
        let mut g = natural.all.clone();
        g.scale_rows(&scale);
        let balance = Rc::new(ForceBalance::new(comm, g.clone(), natural));
        let (lambda, image) = (dual.multipliers()?, dual.multipliers()?);
        drop(dual);
        let mut a = Augmented {
            method,
            scale,
            g,
            balance,
            rho: 0.0,
            precondition: settings.face_pc,
            face: Face::of(method),
            face_balance: None,
            lambda,
            image,
        };
        a.rho = tuning.penalty * a.norm(tuning.power_steps)?;
        Ok(a)
    }

    /// λ = S x.
    pub fn unscaled(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.scale).map(|(x, s)| x * s).collect()
    }

    /// x = S⁻¹ λ, zero where S is zero.
    pub fn scaled(&self, lambda: &[f64]) -> Vec<f64> {
        let rows = lambda.iter().zip(&self.scale);
        rows.map(|(l, s)| if *s > 0.0 { l / s } else { 0.0 })
            .collect()
    }

    /// The disc of a node in scaled variables, where its bound is `g`.
    pub fn disc(&self, node: &Node, g: f64) -> Disc {
        Disc {
            rows: node.tangential.clone(),
            radius: g / self.scale[node.tangential[0]],
        }
    }

    /// y ← S (F + C) S x.
    fn f(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        let lambda = self.unscaled(x);
        self.lambda.array_mut()?.copy_from_slice(&lambda);
        self.method.system.heed()?;
        let dual = self.method.dual();
        dual.stiffness.f_mult_all(&self.lambda, &self.image)?;
        for ((y, f), s) in y.iter_mut().zip(&*self.image.array()?).zip(&self.scale) {
            *y = f * s;
        }
        let rows = dual.stiffness.jump.compliance.iter().zip(&lambda);
        for ((y, s), (c, l)) in y.iter_mut().zip(&self.scale).zip(rows) {
            *y += s * c * l;
        }
        Ok(())
    }

    /// The largest eigenvalue of Pᵀ (F + C) P by the power method. The method gives a lower bound; a few per cent are
    /// added.
    fn norm(&mut self, steps: usize) -> Result<f64> {
        let method = self.method;
        let comm = method.session.comm();
        let balance = self.balance.clone();
        let first = method.dual().stiffness.jump.first;
        let mut x: Vec<f64> = (0..self.scale.len())
            .map(|i| 2.0 * ((first + i + 1) as f64 * 0.618_033_988_749_894_9).fract() - 1.0)
            .zip(&self.scale)
            .map(|(v, s)| if *s > 0.0 { v } else { 0.0 })
            .collect();
        let mut y = vec![0.0; x.len()];
        let mut largest = 0.0;
        for _ in 0..steps {
            balance.project(comm, &mut x);
            let square = total(comm, x.iter().map(|x| x * x).sum());
            if square == 0.0 {
                break;
            }
            let root = square.sqrt();
            x.iter_mut().for_each(|x| *x /= root);
            self.f(&x, &mut y)?;
            balance.project(comm, &mut y);
            largest = total(comm, y.iter().map(|y| y * y).sum()).sqrt();
            std::mem::swap(&mut x, &mut y);
        }
        Ok(if largest > 0.0 { 1.1 * largest } else { 1.0 })
    }
}

impl BoundedQuadratic for Augmented<'_> {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        let comm = self.method.session.comm();
        let balance = self.balance.clone();
        let mut inside = x.to_vec();
        let c = balance.project(comm, &mut inside); /*    P x             */
        self.f(&inside, y)?;
        balance.project(comm, y); /*                      Pᵀ (F + C) P x  */
        balance.add(self.rho, &c, y); /*                  + ϱ (I − P) x   */
        Ok(())
    }

    fn enter(&mut self, free: &[bool]) -> Result<()> {
        if !self.precondition {
            return Ok(());
        }
        let session = &self.method.session;
        self.face.enter(free);
        let mut g = self.g.clone();
        let mask: Vec<f64> = free.iter().map(|&on| f64::from(u8::from(on))).collect();
        g.scale_rows(&mask);
        let dual = self.method.dual();
        self.face_balance = Some(ForceBalance::new(session.comm(), g, &dual.natural));
        Ok(())
    }

    fn precondition(&mut self, v: &[f64], z: &mut [f64]) -> Result<()> {
        let Some(face) = &self.face_balance else {
            z.copy_from_slice(v);
            return Ok(());
        };
        let comm = self.method.session.comm();
        let mut inside = v.to_vec();
        let c = face.project(comm, &mut inside); /*       c = N_F⁺ G_Fᵀ v */
        let lambda = self.scaled(&inside);
        self.lambda.array_mut()?.copy_from_slice(&lambda);
        {
            let dual = self.method.dual();
            dual.m(&self.lambda, &self.image)?;
        }
        let image = self.image.to_vec()?;
        z.copy_from_slice(&self.scaled(&image));
        face.project(comm, z);
        let mut d = self.balance.product(comm, &c);
        face.solve(&mut d);
        face.add(1.0 / self.rho, &d, z);
        Ok(())
    }
}
