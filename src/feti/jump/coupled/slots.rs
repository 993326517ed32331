//! The dofs of coupled blocks and their copies: where B_Dᵀ λ goes to and B_D y comes from.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::feti::interface::location::Locations;
use crate::feti::jump::blocks::Block;
use base::linalg::sorted::distinct;
use parallel::exchange::{any, exchange, offsets};

/// The dofs of coupled blocks, numbered block after block on the rank that owns the block.
#[derive(Debug, Clone, Default)]
pub struct Slots {
    /// Whether some rank has a coupled block.
    pub anywhere: bool,
    /// Number of dofs of this rank's blocks.
    pub n_owned: usize,
    /// Global number of each dof that a subdomain of this rank has, increasing.
    pub ghosts: Vec<u32>,
}

/// (Index among the ghosts, local dof) of the dofs in coupled blocks that a subdomain has.
pub type CoupledDofs = Vec<(u32, u32)>;

impl Slots {
    /// Tells the subdomains which of their dofs are in coupled blocks. Also returns these places for each local
    /// subdomain; `subdomains` lists them. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        blocks: &[Block],
        locations: &Locations,
        subdomains: &[u32],
    ) -> (Slots, Vec<CoupledDofs>) {
        let mut places: Vec<CoupledDofs> = vec![Vec::new(); subdomains.len()];
        let n_owned = blocks.iter().map(|b| b.slots.len()).sum();
        if !any(comm, n_owned > 0) {
            return (Slots::default(), places);
        }
        let (first, _) = offsets(comm, n_owned);
        let mut outgoing: Vec<Vec<[u32; 3]>> = vec![Vec::new(); comm.size() as usize];
        for block in blocks {
            for (slot, copies) in block.slots.clone().zip(block.copies()) {
                for copy in copies {
                    let to = &mut outgoing[locations.rank(copy.subdomain)];
                    to.push([copy.subdomain, copy.local, (first + slot) as u32]);
                }
            }
        }
        let received = exchange(comm, outgoing);
        let ghosts = distinct(received.iter().map(|&[_, _, slot]| slot));
        for [subdomain, local, slot] in received {
            let j = subdomains.binary_search(&subdomain);
            let ghost = ghosts.binary_search(&slot);
            let place = (ghost.expect("it was collected") as u32, local);
            places[j.expect("it was sent to the rank of the subdomain")].push(place);
        }
        places.iter_mut().for_each(|list| list.sort_unstable());
        let slots = Slots {
            anywhere: true,
            n_owned,
            ghosts,
        };
        (slots, places)
    }
}
