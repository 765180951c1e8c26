//! A page of HTML that needs no other file.

use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{Chart, Table, escaped, files};
use crate::convergence::Convergence;

/// A page of HTML that needs no other file, no network and no scripts.
///
/// Everything is added in the order in which it is to be read. Text is plain text; what stands between two backquotes is
/// set as code.
///
/// ```
/// use estimand::report::Page;
///
/// let mut page = Page::new("A <small> page");
/// page.section("One").text("`x < y` holds.");
/// let html = page.html();
/// assert!(html.contains("<h1>A &lt;small&gt; page</h1>"));
/// assert!(html.contains("<p><code>x &lt; y</code> holds.</p>"));
/// ```
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    /// What stands before the contents.
    opening: String,
    body: String,
    sections: Vec<String>,
}

/// A picture with its caption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// A file in the PNG format.
    pub png: Vec<u8>,
    /// What is to be seen.
    pub caption: String,
}

impl Page {
    /// A page without content.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            opening: String::new(),
            body: String::new(),
            sections: Vec::new(),
        }
    }

    /// Begins a section, which the contents at the top of the page name. What was added before the first one stands above
    /// the contents.
    pub fn section(&mut self, heading: &str) -> &mut Self {
        if self.sections.is_empty() {
            self.opening = std::mem::take(&mut self.body);
        }
        self.sections.push(heading.to_owned());
        let number = self.sections.len();
        self.push(&format!(
            "<h2 id=\"section-{number}\">{number}. {}</h2>\n",
            escaped(heading)
        ))
    }

    /// Begins a part of a section.
    pub fn subsection(&mut self, heading: &str) -> &mut Self {
        self.push(&format!("<h3>{}</h3>\n", escaped(heading)))
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: &str) -> &mut Self {
        let mut paragraph = String::from("<p>");
        for (part, text) in text.split('`').enumerate() {
            let text = escaped(text);
            if part % 2 == 1 {
                let _ = write!(paragraph, "<code>{text}</code>");
            } else {
                paragraph.push_str(&text);
            }
        }
        self.push(&(paragraph + "</p>\n"))
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) -> &mut Self {
        self.push(&table.html())
    }

    /// Adds charts, side by side where there is room.
    pub fn charts<'a>(&mut self, charts: impl IntoIterator<Item = &'a Chart>) -> &mut Self {
        self.push("<div class=\"charts\">\n");
        for chart in charts {
            let (title, svg) = (escaped(chart.title()), chart.svg());
            self.push(&format!(
                "<figure><figcaption>{title}</figcaption>{svg}</figure>\n"
            ));
        }
        self.push("</div>\n")
    }

    /// Adds pictures, side by side where there is room.
    pub fn pictures<'a>(&mut self, pictures: impl IntoIterator<Item = &'a Picture>) -> &mut Self {
        self.push("<div class=\"pictures\">\n");
        for Picture { png, caption } in pictures {
            let (caption, data) = (escaped(caption), STANDARD.encode(png));
            self.push(&format!(
                "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
                 <figcaption>{caption}</figcaption></figure>\n"
            ));
        }
        self.push("</div>\n")
    }

    /// Adds links to files beside the page, by their names.
    pub fn files<'a>(&mut self, names: impl IntoIterator<Item = &'a str>) -> &mut Self {
        let links: Vec<String> = names
            .into_iter()
            .map(|name| format!("<a href=\"{0}\">{0}</a>", escaped(name)))
            .collect();
        self.push(&format!("<p>Data: {}</p>\n", links.join(", ")))
    }

    /// Adds what a study has found: its error over time and over evaluations, a row of figures a method, and how long each
    /// takes to errors of 1 % and 0.1 % where it is known [of what](Convergence::scale).
    pub fn study(&mut self, heading: &str, convergence: &Convergence) -> &mut Self {
        self.subsection(heading);
        self.charts([
            &Chart::over_time("Error over time", convergence),
            &Chart::over_evaluations("Error over evaluations, with slopes", convergence),
        ]);
        if convergence.scale.is_some() {
            self.table(&Table::of_times(convergence, &[0.01, 0.001]));
        }
        self.table(&Table::of_study(convergence))
    }

    fn push(&mut self, html: &str) -> &mut Self {
        self.body.push_str(html);
        self
    }

    /// The page.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let mut contents = String::new();
        if self.sections.len() > 1 {
            contents.push_str("<nav aria-label=\"Contents\"><ol>\n");
            for (number, section) in (1..).zip(&self.sections) {
                let section = escaped(section);
                let _ = writeln!(
                    contents,
                    "<li><a href=\"#section-{number}\">{section}</a></li>"
                );
            }
            contents.push_str("</ol></nav>\n");
        }
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
             <style>\n{}{}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{}{contents}<main>\n{}</main>\n</body>\n</html>\n",
            include_str!("page.css"),
            include_str!("chart.css"),
            self.opening,
            self.body
        )
    }

    /// Writes the page as `index.html` into `folder`, which is made if it is not there, and returns its path.
    ///
    /// # Errors
    ///
    /// If the folder cannot be made or the file not written.
    pub fn write(&self, folder: impl AsRef<Path>) -> io::Result<PathBuf> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).map_err(|error| {
            io::Error::new(error.kind(), format!("{}: {error}", folder.display()))
        })?;
        let path = folder.join("index.html");
        files::write(&path, self.html().as_bytes())?;
        Ok(path)
    }
}
