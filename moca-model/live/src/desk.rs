//! State that the loop and the pages share.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use moca_replay::recorded::Sampler;
use moca_simulation::workcell::{Memory, Workcell};

use crate::error::Error;
use crate::head::Head;
use crate::picture::Picture;
use crate::request::Request;

/// Largest number of orders that wait for the next tick.
const WAITING: usize = 64;

/// Order of a page to the loop.
#[derive(Debug)]
pub enum Order {
    /// Request of the page that steers, with the number of its message.
    Request(Request, u64),
    /// Goes on with another workcell.
    Replace(Box<(Workcell, Sampler)>, u64),
    /// Says what has happened so far.
    Remember(SyncSender<Memory>),
    /// Nobody steers any more: the people stand still.
    Abandon,
}

/// The newest picture, the orders to come, and the page that steers. Nobody who holds it makes the loop wait.
#[derive(Debug)]
pub struct Desk {
    newest: Mutex<Option<Arc<Picture>>>,
    head: Mutex<Arc<Head>>,
    orders: SyncSender<Order>,
    /// The page that steers; 0 if none.
    steers: AtomicU64,
    /// Pages so far.
    pages: AtomicU64,
    ends: AtomicBool,
}

impl Desk {
    /// Begins with what a page is told first; gives the loop's end of the orders as well.
    pub fn new(head: Head) -> (Arc<Self>, Receiver<Order>) {
        let (orders, receiver) = sync_channel(WAITING);
        let desk = Self {
            newest: Mutex::new(None),
            head: Mutex::new(Arc::new(head)),
            orders,
            steers: AtomicU64::new(0),
            pages: AtomicU64::new(0),
            ends: AtomicBool::new(false),
        };
        (Arc::new(desk), receiver)
    }

    /// Shows a picture in place of the one before. Does without, if somebody reads at this moment.
    pub fn show(&self, picture: Picture) {
        if let Ok(mut newest) = self.newest.try_lock() {
            *newest = Some(Arc::new(picture));
        }
    }

    /// The newest picture.
    pub fn newest(&self) -> Option<Arc<Picture>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// First message to a page.
    pub fn head(&self) -> Arc<Head> {
        Arc::clone(&self.head.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(crate) fn set_head(&self, head: Head) {
        *self.head.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(head);
    }

    /// Gives the loop an order.
    ///
    /// # Errors
    /// [`Error::Busy`].
    pub fn order(&self, order: Order) -> Result<(), Error> {
        self.orders.try_send(order).map_err(|_| Error::Busy)
    }

    /// A number for a page.
    pub(crate) fn enter(&self) -> u64 {
        self.pages.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// True if a page steers: the first that asks while nobody does.
    pub(crate) fn steers(&self, page: u64) -> bool {
        let taken = self.steers.compare_exchange(0, page, Ordering::AcqRel, Ordering::Acquire);
        taken.is_ok() || taken == Err(page)
    }

    /// A page has left; if it steered, the people stand still.
    pub(crate) fn leave(&self, page: u64) {
        let left = self.steers.compare_exchange(page, 0, Ordering::AcqRel, Ordering::Acquire);
        if left.is_ok() {
            // A loop that takes no orders has ended.
            let _ = self.order(Order::Abandon);
        }
    }

    /// Tells the server that the loop has ended.
    pub fn end(&self) {
        self.ends.store(true, Ordering::Release);
    }

    /// Returns true if the loop has ended.
    pub fn has_ended(&self) -> bool {
        self.ends.load(Ordering::Acquire)
    }
}
