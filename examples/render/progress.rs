//! The progress bar.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of the bar.
const STEPS: u64 = 10_000;

/// The bar, on the standard error if that is a terminal.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(STEPS);
        let style =
            ProgressStyle::with_template("{bar:30} {percent:>3} % {elapsed} / {eta} left  {msg}");
        bar.set_style(style.expect("the template is valid"));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Shows how much is done, at which rate, and the error so far.
    pub(crate) fn show(&self, fraction: Option<f64>, paths: u64, seconds: f64, noise: Option<f64>) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a fraction of the steps"
        )]
        let position = (fraction.unwrap_or(0.0) * STEPS as f64) as u64;
        self.0.set_position(position);
        let rate = paths as f64 / seconds.max(1e-9) / 1e6;
        let noise = noise.map_or_else(String::new, |noise| {
            format!(", noise {:.2} %", 100.0 * noise)
        });
        self.0.set_message(format!("{rate:.2} M paths/s{noise}"));
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
