//! `$name`s and what they stand for.

use super::super::Code;
use super::super::error::{closest, quoted};

/// The expansions of one scene may come to this many bytes in all: definitions may use definitions, and would
/// otherwise double at every line.
const MAX_EXPANSION: usize = 16 << 20;

/// A scene may have this many definitions: each `$` is held against all of them.
const MAX_DEFINITIONS: usize = 1024;

/// The values that `$name`s stand for, longest name first.
#[derive(Debug)]
pub(super) struct Definitions {
    entries: Vec<Definition>,
    n_expanded: usize,
}

#[derive(Debug)]
struct Definition {
    name: String,
    value: String,
    used: bool,
}

/// What went wrong with a `$name`, before it is known where.
pub(super) struct Refusal {
    pub code: Code,
    pub found: String,
    pub suggestion: Option<String>,
}

impl Definitions {
    /// Definitions given from outside; all of them must come to be used.
    pub(super) fn new(given: &[(String, String)]) -> Result<Self, Refusal> {
        let mut definitions = Self { entries: Vec::new(), n_expanded: 0 };
        for (name, value) in given {
            if definitions.entries.iter().any(|d| d.name == *name) {
                let found = format!("{} is defined twice", quoted(name));
                return Err(Refusal { code: Code::InvalidDefinition, found, suggestion: None });
            }
            definitions.insert(name, value, false)?;
        }
        Ok(definitions)
    }

    /// A value for where none was given from outside, or by an earlier default.
    pub(super) fn default(&mut self, name: &str, value: &str) -> Result<(), Refusal> {
        if self.entries.iter().any(|d| d.name == name) {
            return Ok(());
        }
        self.insert(name, value, true)
    }

    fn insert(&mut self, name: &str, value: &str, used: bool) -> Result<(), Refusal> {
        if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c)) {
            let found = format!("{} cannot be the name of a definition", quoted(name));
            return Err(Refusal { code: Code::InvalidDefinition, found, suggestion: None });
        }
        if self.entries.len() == MAX_DEFINITIONS {
            let found = format!("the scene has more than {MAX_DEFINITIONS} definitions");
            return Err(Refusal { code: Code::BeyondLimits, found, suggestion: None });
        }
        let at = self.entries.partition_point(|d| d.name.len() >= name.len());
        self.entries.insert(at, Definition { name: name.to_string(), value: value.to_string(), used });
        Ok(())
    }

    /// Replaces every `$name` by its value, the longest name that fits first; `\$` stands for a dollar sign. What
    /// comes out of an expansion is not expanded again.
    pub(super) fn expand(&mut self, text: &str) -> Result<String, Refusal> {
        let mut out = String::new();
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = after;
                continue;
            }
            let Some(definition) = self.entries.iter_mut().find(|d| after.starts_with(&d.name)) else {
                return Err(self.undefined(after));
            };
            definition.used = true;
            self.n_expanded += definition.value.len();
            if self.n_expanded > MAX_EXPANSION {
                let found = format!("the definitions of this scene expand to more than {} MiB", MAX_EXPANSION >> 20);
                return Err(Refusal { code: Code::InvalidDefinition, found, suggestion: None });
            }
            out.push_str(before);
            out.push_str(&definition.value);
            rest = &after[definition.name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }

    fn undefined(&self, after: &str) -> Refusal {
        let end = after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len());
        let name = &after[..end];
        let names: Vec<&str> = self.entries.iter().map(|d| d.name.as_str()).collect();
        Refusal {
            code: Code::UndefinedName,
            found: format!("{} is not defined", quoted(&format!("${name}"))),
            suggestion: closest(name, &names).map(|n| format!("${n}")),
        }
    }

    /// Refuses definitions from outside that nothing used.
    pub(super) fn check_used(&self) -> Result<(), Refusal> {
        let Some(unused) = self.entries.iter().find(|d| !d.used) else { return Ok(()) };
        let others: Vec<&str> = self.entries.iter().filter(|d| d.used).map(|d| d.name.as_str()).collect();
        Err(Refusal {
            code: Code::UnusedDefinition,
            found: format!("{} is defined from outside and used nowhere", quoted(&unused.name)),
            suggestion: closest(&unused.name, &others).map(str::to_string),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(definitions: &[(&str, &str)], text: &str) -> Result<String, Code> {
        let given: Vec<_> = definitions.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        Definitions::new(&given).and_then(|mut d| d.expand(text)).map_err(|refusal| refusal.code)
    }

    #[test]
    fn longest_name_wins_and_dollars_may_be_escaped() {
        let definitions = [("a", "1"), ("ab", "2")];
        assert_eq!(expand(&definitions, "$a $ab $abc x$a").as_deref(), Ok("1 2 2c x1"));
        assert_eq!(expand(&definitions, "\\$a").as_deref(), Ok("$a"));
        assert_eq!(expand(&[("a", "$a")], "$a").as_deref(), Ok("$a"));
        assert_eq!(expand(&definitions, "$"), Err(Code::UndefinedName));
        assert_eq!(expand(&[("", "1")], "x"), Err(Code::InvalidDefinition));
    }

    #[test]
    fn a_doubling_chain_is_refused() {
        let Ok(mut definitions) = Definitions::new(&[]) else { panic!("no definitions are fine") };
        assert!(definitions.default("x0", "0123456789").is_ok());
        let refused = (1..64).find_map(|i| {
            let previous = format!("$x{}", i - 1);
            let doubled = definitions.expand(&format!("{previous}{previous}"));
            match doubled {
                Ok(value) => definitions.default(&format!("x{i}"), &value).err(),
                Err(refusal) => Some(refusal),
            }
        });
        assert_eq!(refused.map(|r| r.code), Some(Code::InvalidDefinition));
    }
}
