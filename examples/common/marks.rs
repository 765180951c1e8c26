//! Colours and markers that tell curves apart, also without colour.

use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use plotters_backend::{BackendCoord, DrawingErrorKind};

/// The shape of a marker.
#[derive(Clone, Copy)]
pub(crate) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
    Plus,
    Ring,
}

/// Colours of Okabe and Ito (2008), which stay apart for colour-blind eyes, each with a marker of its own.
pub(crate) const LOOKS: [(RGBColor, Marker); 7] = [
    (RGBColor(0, 0, 0), Marker::Circle),
    (RGBColor(230, 159, 0), Marker::Square),
    (RGBColor(86, 180, 233), Marker::Triangle),
    (RGBColor(0, 114, 178), Marker::Ring),
    (RGBColor(0, 158, 115), Marker::Diamond),
    (RGBColor(213, 94, 0), Marker::Cross),
    (RGBColor(204, 121, 167), Marker::Plus),
];

/// A marker of some pixels around a point of the chart or of the picture.
pub(crate) struct Mark<C> {
    pub(crate) at: C,
    pub(crate) marker: Marker,
    pub(crate) color: RGBColor,
}

impl<'a, C> PointCollection<'a, C> for &'a Mark<C> {
    type Point = &'a C;
    type IntoIter = std::iter::Once<&'a C>;

    fn point_iter(self) -> Self::IntoIter {
        std::iter::once(&self.at)
    }
}

impl<C, DB: DrawingBackend> Drawable<DB> for Mark<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        points: I,
        backend: &mut DB,
        _: (u32, u32),
    ) -> Result<(), DrawingErrorKind<DB::ErrorType>> {
        let pen = self.color.stroke_width(2);
        for (x, y) in points {
            let around = |offsets: &[BackendCoord]| -> Vec<BackendCoord> {
                offsets.iter().map(|(dx, dy)| (x + dx, y + dy)).collect()
            };
            match self.marker {
                Marker::Circle => backend.draw_circle((x, y), 4, &self.color, true)?,
                Marker::Ring => backend.draw_circle((x, y), 5, &pen, false)?,
                Marker::Square => {
                    backend.draw_rect((x - 4, y - 4), (x + 4, y + 4), &self.color, true)?;
                }
                Marker::Triangle => {
                    backend.fill_polygon(around(&[(-5, 4), (5, 4), (0, -6)]), &self.color)?;
                }
                Marker::Diamond => {
                    let corners = around(&[(0, -6), (6, 0), (0, 6), (-6, 0)]);
                    backend.fill_polygon(corners, &self.color)?;
                }
                Marker::Cross => {
                    backend.draw_path(around(&[(-5, -5), (5, 5)]), &pen)?;
                    backend.draw_path(around(&[(-5, 5), (5, -5)]), &pen)?;
                }
                Marker::Plus => {
                    backend.draw_path(around(&[(-6, 0), (6, 0)]), &pen)?;
                    backend.draw_path(around(&[(0, -6), (0, 6)]), &pen)?;
                }
            }
        }
        Ok(())
    }
}
