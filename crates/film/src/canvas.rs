//! A picture that is drawn on: rectangles, and text in the one font that figures have.
//!
//! Everything is in bytes of sRGB, since it is drawn to be looked at. Edges of letters are blended in sRGB as well, which
//! is what screens' fonts are made for.

use crate::error::FilmError;
use ab_glyph::{Font, FontRef, Glyph, Point, PxScale, ScaleFont};
use std::path::Path;

/// DejaVu Sans: Latin, Greek, digits above and below the line (crates/film/fonts).
const FONT: &[u8] = include_bytes!("../fonts/DejaVuSans-subset.ttf");

/// A colour in sRGB.
pub type Color = [u8; 3];

/// Pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    size: [u32; 2],
    pixels: Vec<Color>,
}

/// What a text is drawn with.
#[derive(Debug)]
pub struct Pen {
    font: FontRef<'static>,
}

impl Pen {
    /// The font of the program.
    ///
    /// # Errors
    /// None: the font is part of the program. A damaged program is said to be that.
    pub fn new() -> Result<Self, FilmError> {
        FontRef::try_from_slice(FONT).map(|font| Self { font }).map_err(|_| FilmError::Font)
    }

    /// The letters of a text from x = 0 on, on a base line at y = 0, and where it ends. What the font lacks is a box.
    fn glyphs(&self, text: &str, height: f32) -> (Vec<Glyph>, f32) {
        let scale = PxScale::from(height);
        let scaled = self.font.as_scaled(scale);
        let mut at = 0.0;
        let mut glyphs = Vec::new();
        for letter in text.chars().filter(|letter| !letter.is_control()) {
            let id = self.font.glyph_id(letter);
            glyphs.push(id.with_scale_and_position(scale, Point { x: at, y: 0.0 }));
            at += scaled.h_advance(id);
        }
        (glyphs, at)
    }

    /// Columns that a text takes up at a height of so many pixels from line to line.
    #[must_use]
    pub fn width(&self, text: &str, height: f32) -> f32 {
        self.glyphs(text, height).1
    }
}

impl Canvas {
    /// A canvas of one colour.
    #[must_use]
    pub fn new(size: [u32; 2], color: Color) -> Self {
        Self { size, pixels: vec![color; size[0] as usize * size[1] as usize] }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[Color] {
        &self.pixels
    }

    /// Fills a rectangle from its upper left corner on; what lies outside is left out.
    pub fn fill(&mut self, [left, top]: [i64; 2], [width, height]: [i64; 2], color: Color) {
        for y in top..top + height {
            for x in left..left + width {
                if let Some(pixel) = self.pixel(x, y) {
                    *pixel = color;
                }
            }
        }
    }

    /// Draws a text whose base line begins at a place.
    pub fn text(&mut self, pen: &Pen, text: &str, [x, y]: [f32; 2], height: f32, color: Color) {
        for glyph in pen.glyphs(text, height).0 {
            let Some(outline) = pen.font.outline_glyph(glyph) else { continue }; // a space
            let corner = outline.px_bounds().min;
            let (left, top) = ((x + corner.x).round() as i64, (y + corner.y).round() as i64);
            outline.draw(|column, row, coverage| {
                let place = (left + i64::from(column), top + i64::from(row));
                if let Some(pixel) = self.pixel(place.0, place.1) {
                    let blend = |i: usize| {
                        let (under, over) = (f32::from(pixel[i]), f32::from(color[i]));
                        (under + coverage.clamp(0.0, 1.0) * (over - under)).round() as u8
                    };
                    *pixel = [0, 1, 2].map(blend);
                }
            });
        }
    }

    fn pixel(&mut self, x: i64, y: i64) -> Option<&mut Color> {
        let [width, height] = self.size.map(i64::from);
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        if inside { self.pixels.get_mut((y * width + x) as usize) } else { None }
    }

    /// Writes it as a PNG.
    ///
    /// # Errors
    /// As [`write()`](crate::write()).
    pub fn write(&self, path: &Path) -> Result<(), FilmError> {
        crate::write_png(self.size, &self.pixels, path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_as_wide_as_it_says_and_stays_on_the_canvas() {
        let pen = Pen::new().expect("a font");
        let mut canvas = Canvas::new([200, 40], [255; 3]);
        let width = pen.width("Dichte [kg m⁻³]", 16.0);
        canvas.text(&pen, "Dichte [kg m⁻³]", [10.0, 25.0], 16.0, [0; 3]);
        let dark = |x: usize| (0..40).any(|y| canvas.pixels()[y * 200 + x][0] < 128);
        let columns: Vec<usize> = (0..200).filter(|&x| dark(x)).collect();
        assert!(columns[0] >= 10 && columns[0] <= 13, "{columns:?}");
        let last = *columns.last().expect("letters") as f32;
        assert!(last < 10.0 + width && last > 10.0 + width - 4.0, "{last} {width}");
        // Over the edges, and what the font lacks.
        canvas.text(&pen, "密度\n", [-5.0, 3.0], 30.0, [0; 3]);
        canvas.text(&pen, "overflow", [190.0, 39.0], 30.0, [0; 3]);
        canvas.fill([-5, -5], [1000, 1000], [1, 2, 3]);
        assert!(canvas.pixels().iter().all(|pixel| *pixel == [1, 2, 3]));
    }
}
