//! The arguments of a bench that is no divan bench: sections, flags and numbers.

/// The arguments after those that cargo adds.
pub struct Arguments(Vec<String>);

impl Arguments {
    pub fn of_process() -> Self {
        let arguments = std::env::args().skip(1);
        Self(arguments.filter(|argument| argument != "--bench").collect())
    }

    pub fn is_set(&self, flag: &str) -> bool {
        self.0.iter().any(|argument| argument == flag)
    }

    /// The argument after a flag.
    pub fn value(&self, flag: &str) -> Option<String> {
        let at = self.0.iter().position(|argument| argument == flag)?;
        self.0.get(at + 1).cloned()
    }

    /// The number after a flag.
    pub fn number(&self, flag: &str, otherwise: usize) -> usize {
        self.value(flag)
            .map_or(otherwise, |text| text.parse().unwrap())
    }

    /// Whether a section is asked for; all are where none is named.
    pub fn wants(&self, section: &str, sections: &[&str]) -> bool {
        self.is_set(section) || !sections.iter().any(|name| self.is_set(name))
    }
}
