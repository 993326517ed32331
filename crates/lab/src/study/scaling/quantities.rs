//! Records of numbers that are also lists: seconds by phase, and the work they depend on.

use serde::{Deserialize, Serialize};

/// A record of numbers with names, in an order.
macro_rules! quantities {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $text:literal),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
        pub struct $name {
            $($(#[$doc])* pub $field: f64),+
        }

        impl $name {
            /// The names of the numbers, in order.
            pub const NAMES: [&'static str; [$($text),+].len()] = [$($text),+];

            /// The numbers, in order.
            pub fn all(&self) -> [f64; Self::NAMES.len()] {
                [$(self.$field),+]
            }

            /// Makes the record from a function of the index.
            pub fn from_fn(of: impl Fn(usize) -> f64) -> $name {
                let mut at = 0..;
                $(let $field = of(at.next().expect("an endless range"));)+
                $name { $($field),+ }
            }

            /// Their sum.
            pub fn sum(&self) -> f64 {
                self.all().iter().sum()
            }
        }
    };
}

quantities! {
    /// Seconds of set-up by phase.
    SetupSeconds {
        /// Factors, S, T and Ψ of the subdomains.
        local: "subdomains",
        /// S_Π of the bodies.
        primal: "S_Π",
        /// Z_c and A of the bodies.
        lifting: "Z_c",
        /// G and Gᵀ Q G, without the next two.
        natural: "GᵀQG",
        /// The factor of Gᵀ G.
        factor: "factor",
        /// Order and pattern of Gᵀ Q G, which every rank has for all bodies.
        order: "order",
        /// Everything else: who shares what, B and B_D, kernels.
        rest: "rest",
    }
}

quantities! {
    /// Seconds of an iteration by phase.
    IterationSeconds {
        /// Products with the operators of the subdomains, rows of G, vectors; in measurements also the inner products
        /// of CG.
        local: "subdomains",
        /// S_Π⁺.
        primal: "S_Π",
        /// A⁺.
        lifting: "Z_c",
        /// (Gᵀ Q G)⁻¹.
        natural: "GᵀQG",
        /// Messages between neighbours with their copies.
        exchange: "messages",
        /// All-reduces: in measurements of the projector, in the model also those of CG.
        reduction: "all-reduces",
    }
}

quantities! {
    /// The quantities that costs depend on, for one rank.
    Work {
        /// Subdomains.
        subdomains: "subdomains",
        /// Unknowns of the subdomains.
        unknowns: "unknowns",
        /// Σ n_Γ² + n_Δ², entries of S and T.
        interface_squares: "interface^2",
        /// Σ n_Γ³.
        interface_cubes: "interface^3",
        /// Owned multipliers.
        multipliers: "multipliers",
        /// Numbers that halo exchanges send in an iteration.
        ghosts: "ghosts",
        /// Owned primal dofs.
        primal: "primal",
        /// Σ n log n of the bodies' primal dofs.
        primal_factor: "primal log primal",
        /// Columns of Z_c.
        lifting: "columns",
        /// Σ over bodies of their columns squared.
        lifting_squares: "columns^2",
        /// Σ over bodies of their columns cubed.
        lifting_cubes: "columns^3",
        /// Σ n_Γ² · columns of the subdomain.
        lifting_products: "interface^2 columns",
        /// r, the kernel vectors of all bodies: the same on every rank.
        kernels: "r",
    }
}

#[cfg(test)]
#[path = "../../../tests/study/scaling/quantities.rs"]
mod tests;
