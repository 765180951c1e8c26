//! Parameters of scene files: `$name` in an attribute stands for a value.

/// The values of the parameters, those with longer names first, so that `$spp_max` is not taken for `$spp`.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    entries: Vec<Parameter>,
}

#[derive(Debug)]
struct Parameter {
    name: String,
    value: String,
    used: bool,
}

/// A `$name` without a value.
pub(super) struct Undefined {
    pub(super) name: String,
}

impl Parameters {
    /// The given values.
    pub(super) fn new(overrides: &[(&str, &str)]) -> Self {
        let mut parameters = Self::default();
        for (name, value) in overrides {
            parameters.insert(name, value, false);
        }
        parameters
    }

    /// The value of a `<default>`, unless there is one already. A default need not be used.
    pub(super) fn default_to(&mut self, name: &str, value: &str) {
        if !self.entries.iter().any(|entry| entry.name == name) {
            self.insert(name, value, true);
        }
    }

    fn insert(&mut self, name: &str, value: &str, used: bool) {
        let at = self
            .entries
            .partition_point(|entry| entry.name.len() >= name.len());
        let (name, value) = (name.to_owned(), value.to_owned());
        self.entries.insert(at, Parameter { name, value, used });
    }

    /// The text with every `$name` replaced, once and from left to right: a value is not searched for names again.
    /// `\$` stands for a dollar sign.
    pub(super) fn substitute(&mut self, text: &str) -> Result<String, Undefined> {
        let mut result = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(escaped) = before.strip_suffix('\\') {
                result.push_str(escaped);
                result.push('$');
                rest = after;
                continue;
            }
            result.push_str(before);
            let found = self
                .entries
                .iter_mut()
                .find(|entry| !entry.name.is_empty() && after.starts_with(&entry.name));
            let Some(parameter) = found else {
                let end = after
                    .find(|c: char| !c.is_ascii_alphanumeric() && c != '_')
                    .unwrap_or(after.len());
                return Err(Undefined {
                    name: after[..end].to_owned(),
                });
            };
            parameter.used = true;
            result.push_str(&parameter.value);
            rest = &after[parameter.name.len()..];
        }
        result.push_str(rest);
        Ok(result)
    }

    /// A value that was given and that no attribute asked for.
    pub(super) fn unused(&self) -> Option<&str> {
        self.entries
            .iter()
            .find(|entry| !entry.used)
            .map(|entry| entry.name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn substitute(parameters: &mut Parameters, text: &str) -> String {
        parameters
            .substitute(text)
            .unwrap_or_else(|undefined| format!("undefined {}", undefined.name))
    }

    #[test]
    fn longer_names_go_first() {
        let mut parameters = Parameters::new(&[("a", "1"), ("ab", "2"), ("b", "3")]);
        assert_eq!(substitute(&mut parameters, "$ab $a$b x$a."), "2 13 x1.");
    }

    #[test]
    fn values_are_not_searched_again() {
        let mut parameters = Parameters::new(&[("a", "$b"), ("b", "$a")]);
        assert_eq!(substitute(&mut parameters, "$a$b"), "$b$a");
    }

    #[test]
    fn overrides_beat_defaults_and_must_be_used() {
        let mut parameters = Parameters::new(&[("spp", "7"), ("size", "9")]);
        parameters.default_to("spp", "64");
        parameters.default_to("depth", "8");
        assert_eq!(substitute(&mut parameters, "$spp \\$spp"), "7 $spp");
        assert_eq!(parameters.unused(), Some("size"));
        assert_eq!(substitute(&mut parameters, "$size"), "9");
        assert_eq!(parameters.unused(), None);
    }

    #[test]
    fn unknown_names_are_told() {
        let mut parameters = Parameters::default();
        assert_eq!(
            substitute(&mut parameters, "a $no_such.b"),
            "undefined no_such"
        );
    }
}
