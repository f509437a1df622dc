//! The answers to a monitoring system that asks a running controller: `/metrics` in the text format of
//! OpenMetrics 1.0, `/healthz`, `/readyz`.
//!
//! The attendant counts; the answers read the counters. Nothing here reaches the scan thread.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::IntoResponse;
use axum::routing::get;
use g7_model::Nanos;
use g7_online::{Mode, Pace};
use g7_store::log;
use prometheus_client::encoding::{EncodeLabelSet, text};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};

use crate::serve::listen::{self, Door};

const TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";
/// Bounds of the times of scans, in s.
const TIMES: [f64; 13] =
    [10e-6, 20e-6, 50e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3, 100e-3, 1.0];

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct OfDevice {
    device: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Newest {
    hash: String,
}

/// How the log is. Its newest row is kept by whoever asks: so rows that are cut off are found.
#[derive(Default)]
struct OfLog {
    newest: Family<Newest, Gauge>,
    lost: Gauge,
    failing: Gauge,
}

/// The counters of a controller.
pub(crate) struct Monitor {
    running: Gauge,
    fault: Gauge,
    missed: Counter,
    late: Histogram,
    took: Histogram,
    up: Family<OfDevice, Gauge>,
    lost: Family<OfDevice, Counter>,
    unsaved: Counter,
    log: OfLog,
    shared: Arc<Shared>,
    /// Serves until it is dropped.
    _runtime: Runtime,
}

struct Shared {
    registry: Registry,
    /// The controller makes scans.
    ready: AtomicBool,
}

impl Monitor {
    /// Counters that are served at an address from here on.
    ///
    /// # Errors
    ///
    /// The address is in use or not one of this machine.
    pub(crate) fn serve(address: SocketAddr) -> std::io::Result<Monitor> {
        let mut registry = Registry::with_prefix("g7");
        let new = || Histogram::new(TIMES);
        let (running, fault, missed, late, took) =
            (Gauge::default(), Gauge::default(), Counter::default(), new(), new());
        let (up, lost, unsaved) = (Family::default(), Family::default(), Counter::default());
        registry.register("running", "1 while the controller makes scans", running.clone());
        registry.register("fault", "1 while the controller is in fault", fault.clone());
        registry.register("scans_left_out", "Scans that came too late and were left out", missed.clone());
        registry.register("scan_late_seconds", "From the instant of a scan to its begin", late.clone());
        registry.register("scan_duration_seconds", "From the begin of a scan to its outputs", took.clone());
        registry.register("device_up", "1 while the device answers", up.clone());
        registry.register("device_losses", "How often the device was lost", lost.clone());
        registry.register("saves_failed", "How often saving of values began to fail", unsaved.clone());
        let log = OfLog::default();
        let newest = "The number of the newest row of the log, with its hash";
        registry.register("log_newest_row", newest, log.newest.clone());
        registry.register(
            "log_events_lost",
            "Events that the log has lost since the start",
            log.lost.clone(),
        );
        registry.register("log_failing", "1 while the log cannot be written", log.failing.clone());
        let shared = Arc::new(Shared { registry, ready: AtomicBool::new(false) });
        let app = Router::new()
            .route("/metrics", get(metrics))
            .route("/healthz", get(|| async { "the controller works\n" }))
            .route("/readyz", get(readyz))
            .with_state(Arc::clone(&shared));
        let runtime =
            Builder::new_multi_thread().worker_threads(1).thread_name("monitor").enable_all().build()?;
        let listener = runtime.block_on(TcpListener::bind(address))?;
        runtime.spawn(listen::listen(listener, app, Door::default()));
        Ok(Monitor { running, fault, missed, late, took, up, lost, unsaved, log, shared, _runtime: runtime })
    }

    /// Notes the mode.
    pub(crate) fn mode(&self, mode: Mode) {
        self.running.set(i64::from(mode == Mode::Run));
        self.fault.set(i64::from(matches!(mode, Mode::Fault(_))));
        self.shared.ready.store(mode == Mode::Run, Ordering::Release);
    }

    /// Counts scans that were left out.
    pub(crate) fn missed(&self, scans: u64) {
        self.missed.inc_by(scans);
    }

    /// Counts a scan.
    pub(crate) fn pace(&self, pace: Pace) {
        let seconds = |time: Nanos| time.count() as f64 / 1e9;
        self.late.observe(seconds(pace.late));
        self.took.observe(seconds(pace.took));
    }

    /// Notes that a device answers, or does not any more.
    pub(crate) fn device(&self, name: &str, up: bool) {
        let of = OfDevice { device: name.to_owned() };
        self.up.get_or_create(&of).set(i64::from(up));
        let lost = self.lost.get_or_create(&of);
        if !up {
            lost.inc();
        }
    }

    /// Notes how the log is.
    pub(crate) fn log(&self, state: &log::State) {
        let whole = |n: u64| i64::try_from(n).unwrap_or(i64::MAX);
        self.log.newest.clear();
        let of = Newest { hash: state.newest.hash.to_string() };
        self.log.newest.get_or_create(&of).set(whole(state.newest.n));
        self.log.lost.set(whole(state.lost));
        self.log.failing.set(i64::from(state.failing.is_some()));
    }

    /// Counts that values could not be saved.
    pub(crate) fn unsaved(&self) {
        self.unsaved.inc();
    }
}

async fn metrics(State(shared): State<Arc<Shared>>) -> impl IntoResponse {
    let mut text = String::new();
    match text::encode(&mut text, &shared.registry) {
        Ok(()) => (StatusCode::OK, [(header::CONTENT_TYPE, TYPE)], text),
        // A String takes all that is written.
        Err(_) => (StatusCode::INTERNAL_SERVER_ERROR, [(header::CONTENT_TYPE, "text/plain")], String::new()),
    }
}

async fn readyz(State(shared): State<Arc<Shared>>) -> (StatusCode, &'static str) {
    if shared.ready.load(Ordering::Acquire) {
        (StatusCode::OK, "the controller runs\n")
    } else {
        (StatusCode::SERVICE_UNAVAILABLE, "the controller is stopped or in fault\n")
    }
}
