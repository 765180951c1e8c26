//! Pages, plots and files of what a [study](crate::convergence) has found.
//!
//! A [`Page`] is one file of HTML that needs no other, no network and no scripts: headings, text, [tables](Table),
//! [charts](Chart) as inline SVG, [pictures](Picture). It is light or dark as the reader's system is, prints, and fits
//! narrow screens. [`Page::study`] puts a whole study on it:
//!
//! ```no_run
#![doc = include_str!("../examples/own_study.rs")]
//! ```
//!
//! Run it by `cargo run --release --features report --example own_study`. The same study as data:
//! [`Convergence::write_csv`](crate::convergence::Convergence::write_csv) and
//! [`write_json`](crate::convergence::Convergence::write_json). The report of this crate about itself is the
//! example `report`.

mod axis;
mod chart;
mod files;
mod looks;
pub mod number;
mod page;
mod table;

pub use axis::{Axis, Ticks};
pub use chart::{Chart, Line, Point};
pub use page::{Page, Picture};
pub use table::{Cell, Column, Table};

/// Text as HTML and XML have it.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            _ => escaped.push(c),
        }
    }
    escaped
}
