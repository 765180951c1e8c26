//! A file of points.

use std::error::Error;
use std::path::Path;

use estimand::discrepancy::Points;

/// Reads points: a line each, numbers between commas, semicolons or blanks. Lines that are blank or begin with `#` are passed
/// over, and so is one heading before the first point, in which nothing is a number.
pub(crate) fn points(
    path: &Path,
    dimensions: Option<u32>,
    count: Option<u64>,
) -> Result<Points<'static>, Box<dyn Error>> {
    let text = if path == Path::new("-") {
        std::io::read_to_string(std::io::stdin())
    } else {
        std::fs::read_to_string(path)
    }
    .map_err(|error| format!("{}: {error}", path.display()))?;
    // Spreadsheets begin a file with a mark of its encoding.
    let text = text.trim_start_matches('\u{feff}');
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut headings = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields = fields(line);
        if rows.is_empty() && headings == 0 && fields.iter().all(|f| f.parse::<f64>().is_err()) {
            headings += 1;
            continue;
        }
        let first = rows.first().map(Vec::len);
        let row = row(&fields, dimensions, first)
            .map_err(|error| format!("{}:{number}: {error}", path.display()))?;
        rows.push(row);
        if count.is_some_and(|count| rows.len() as u64 == count) {
            break;
        }
    }
    if let Some(count) = count.filter(|&count| count > rows.len() as u64) {
        return Err(format!("{}: {} points, not {count}", path.display(), rows.len()).into());
    }
    if rows.is_empty() {
        return Err(format!("{}: no points", path.display()).into());
    }
    Ok(Points::from_slices(&rows)?)
}

/// What is between the commas or semicolons of a line, or, where there are none, between its blanks.
fn fields(line: &str) -> Vec<&str> {
    if line.contains([',', ';']) {
        line.split([',', ';']).map(str::trim).collect()
    } else {
        line.split_whitespace().collect()
    }
}

/// The coordinates of a point: the first `dimensions` of those given, or as many as the `first` point has.
fn row(fields: &[&str], dimensions: Option<u32>, first: Option<usize>) -> Result<Vec<f64>, String> {
    let wanted = dimensions.map_or(first.unwrap_or(fields.len()), |wanted| wanted as usize);
    if fields.len() < wanted || (dimensions.is_none() && fields.len() > wanted) {
        return Err(format!("{} coordinates, not {wanted}", fields.len()));
    }
    let coordinate = |field: &&str| {
        let x = field
            .parse::<f64>()
            .map_err(|_| format!("no number: {field:?}"))?;
        if (0.0..=1.0).contains(&x) {
            Ok(x)
        } else {
            Err(format!("{x} is not in [0, 1]"))
        }
    };
    fields[..wanted].iter().map(coordinate).collect()
}
