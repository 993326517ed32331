//! Messages from one rank to another, which go on their way while the sender computes.

use std::cell::OnceCell;

use mpi::request::{LocalScope, Request};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Source};

use super::traffic::Traffic;
use crate::traffic;

/// The other end of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// The other rank.
    pub rank: i32,
    /// The number that tells the messages between two ranks apart that are on their way at the same time.
    pub tag: i32,
}

/// Messages that are on their way.
pub struct Post<'a, 'b> {
    comm: &'b SimpleCommunicator,
    scope: &'b LocalScope<'a>,
    /// Where their numbers stay until MPI has read them.
    free: std::slice::Iter<'a, OnceCell<Vec<f64>>>,
    sent: Vec<Request<'a, [f64], &'b LocalScope<'a>>>,
}

impl Post<'_, '_> {
    /// Sends numbers.
    ///
    /// # Panics
    /// If more messages are sent than were announced.
    pub fn send(&mut self, to: Address, values: Vec<f64>) {
        traffic::count(Traffic::message(values.len()));
        let slot = self.free.next();
        let slot = slot.expect("no more messages than were announced");
        let values = slot.get_or_init(|| values);
        let rank = self.comm.process_at_rank(to.rank);
        let request = rank.immediate_send_with_tag(self.scope, &values[..], to.tag);
        self.sent.push(request);
    }

    /// Lets MPI work on what has not been received yet. A long message moves on only while its sender is in MPI, where
    /// the hardware does not fetch it: a rank that computes for long calls this now and then.
    pub fn progress(&mut self) {
        if self.sent.is_empty() {
            return;
        }
        let sent = std::mem::take(&mut self.sent);
        let left = sent.into_iter().filter_map(|request| request.test().err());
        self.sent = left.collect();
    }
}

/// Calls `work`, which sends at most `most` messages, and returns when all of them have been received or are kept by
/// MPI. Nothing that `work` receives may wait for what it has not sent yet.
pub fn posting<R>(
    comm: &SimpleCommunicator,
    most: usize,
    work: impl FnOnce(&mut Post<'_, '_>) -> R,
) -> R {
    let slots: Vec<OnceCell<Vec<f64>>> = vec![OnceCell::new(); most];
    mpi::request::scope(|scope| {
        let mut post = Post {
            comm,
            scope,
            free: slots.iter(),
            sent: Vec::with_capacity(most),
        };
        let out = work(&mut post);
        for request in post.sent {
            request.wait_without_status();
        }
        out
    })
}

/// Waits for `n` numbers.
pub fn received(comm: &SimpleCommunicator, from: Address, n: usize) -> Vec<f64> {
    let mut values = vec![0.0; n];
    let rank = comm.process_at_rank(from.rank);
    rank.receive_into_with_tag(&mut values[..], from.tag);
    values
}

/// Waits for numbers, any number of them.
pub fn received_any(comm: &SimpleCommunicator, from: Address) -> Vec<f64> {
    let rank = comm.process_at_rank(from.rank);
    rank.receive_vec_with_tag(from.tag).0
}
