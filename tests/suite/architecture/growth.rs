//! What the application may not grow back into: an operation that many files know, tables of
//! actions too long to read, state that no owner holds.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Item, ItemEnum, ItemMod, ItemStatic, ItemStruct, Macro, Meta};

/// A file below the workspace's folder, and what it says.
pub type Source = (PathBuf, String);

/// A static whose value changes while the program runs: (file, name).
pub type Static = (&'static str, &'static str);

/// Types that change behind a shared reference.
const CHANGING: [&str; 9] = [
    "Cell",
    "RefCell",
    "UnsafeCell",
    "OnceCell",
    "OnceLock",
    "Once",
    "Mutex",
    "RwLock",
    "Condvar",
];

/// One operation: its own file or folder, and what it is named by.
#[derive(Debug, Default)]
struct Operation {
    module: String,
    /// The types that stand for a request, and those of its state.
    types: BTreeSet<String>,
    /// Its fields of `Operations`.
    fields: BTreeSet<String>,
}

/// The operations that more than `most` files name. The operation's own file counts, and a folder
/// of its name counts as one.
pub fn widely_named(folder: &Path, sources: &[Source], most: usize) -> Vec<String> {
    let list = sources
        .iter()
        .find(|(path, _)| *path == folder.join("mod.rs"));
    let state = list
        .map(|(_, text)| fields_of(text, "Operations"))
        .unwrap_or_default();
    // Each file is read once: every operation is looked for in all of them.
    let named: Vec<(&Path, Vec<String>)> = sources
        .iter()
        .map(|(path, text)| (path.as_path(), words(text)))
        .collect();
    let mut operations: BTreeMap<String, Operation> = BTreeMap::new();
    for (path, words) in &named {
        let Some(module) = path
            .strip_prefix(folder)
            .ok()
            .and_then(first_name)
            .filter(|name| name != "mod")
        else {
            continue;
        };
        let operation = operations.entry(module.clone()).or_default();
        operation.module = module;
        for three in words
            .windows(3)
            .filter(|three| three[0] == "Operation" && three[1] == "for")
        {
            operation.types.insert(three[2].clone());
        }
        for two in words.windows(2).filter(|two| two[0] == "struct") {
            operation.fields.extend(
                state
                    .iter()
                    .filter(|(_, of)| *of == two[1])
                    .map(|(name, _)| name.clone()),
            );
        }
    }
    let mut wide = Vec::new();
    for operation in operations.values() {
        let places: BTreeSet<PathBuf> = named
            .iter()
            .filter(|(_, words)| operation.is_named_in(words))
            .map(|(path, _)| folder_of_name(path, &operation.module))
            .collect();
        if places.len() > most {
            let places: Vec<String> = places
                .iter()
                .map(|place| place.display().to_string())
                .collect();
            wide.push(format!(
                "{} is named in {}: {}",
                operation.module,
                places.len(),
                places.join(", ")
            ));
        }
    }
    wide
}

impl Operation {
    fn is_named_in(&self, words: &[String]) -> bool {
        let is_field = |two: &[String]| two[0] == "operations" && self.fields.contains(&two[1]);
        let is_module = |two: &[String]| two[0] == "operations" && two[1] == self.module;
        words.iter().any(|word| self.types.contains(word))
            || words.windows(2).any(|two| is_field(two) || is_module(two))
            // Where the state is declared, its fields are names alone.
            || self.fields.iter().any(|field| words.windows(2).any(|two| two[0] == "pub" && two[1] == *field))
    }
}

/// The first part of a path, without the ending of a file.
fn first_name(path: &Path) -> Option<String> {
    let first = PathBuf::from(path.components().next()?.as_os_str());
    Some(first.file_stem()?.to_string_lossy().into_owned())
}

/// The folder of this name that a file lies in, or the file.
fn folder_of_name(path: &Path, name: &str) -> PathBuf {
    let is_named = |folder: &&Path| folder.file_name().is_some_and(|last| last == name);
    path.ancestors()
        .skip(1)
        .find(is_named)
        .unwrap_or(path)
        .to_path_buf()
}

/// The enums of some sources with more than `most` variants.
pub fn long_enums(sources: &[Source], wanted: impl Fn(&str) -> bool, most: usize) -> Vec<String> {
    let mut long = Vec::new();
    for (path, text) in sources {
        for item in items(text) {
            let Item::Enum(ItemEnum {
                ident, variants, ..
            }) = item
            else {
                continue;
            };
            if wanted(&ident.to_string()) && variants.len() > most {
                long.push(format!(
                    "{}: {ident} has {} variants, not {most}",
                    path.display(),
                    variants.len()
                ));
            }
        }
    }
    long
}

/// The names and the types of a struct's fields; none where a text has no such struct.
pub fn fields_of(text: &str, name: &str) -> Vec<(String, String)> {
    let of_name = items(text).into_iter().find_map(|item| match item {
        Item::Struct(item) if item.ident == name => Some(item),
        _ => None,
    });
    let fields = of_name
        .into_iter()
        .flat_map(|ItemStruct { fields, .. }| fields);
    let last = |ty: &syn::Type| match ty {
        syn::Type::Path(path) => path.path.segments.last().map(|last| last.ident.to_string()),
        _ => None,
    };
    fields
        .filter_map(|field| {
            Some((
                field.ident.as_ref()?.to_string(),
                last(&field.ty).unwrap_or_default(),
            ))
        })
        .collect()
}

/// The statics whose value changes and that are not listed, and listed ones that are not there.
pub fn unlisted_statics(sources: &[Source], listed: &[Static]) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut found = BTreeSet::new();
    for (path, text) in sources {
        let mut statics = Statics::default();
        statics.visit_file(&parse(text));
        let path = path.display().to_string();
        for name in statics.0 {
            if let Some(known) = listed
                .iter()
                .find(|(file, known)| **file == *path && *known == name)
            {
                found.insert(*known);
            } else {
                wrong.push(format!(
                    "{path}: the static {name} changes while the program runs"
                ));
            }
        }
    }
    let lost = listed.iter().filter(|known| !found.contains(*known));
    wrong
        .extend(lost.map(|(file, name)| format!("{file}: there is no static {name} that changes")));
    wrong
}

/// The names of statics whose value changes, outside tests.
#[derive(Default)]
struct Statics(Vec<String>);

impl Statics {
    fn note(&mut self, name: String, of: &[String]) {
        let changes =
            |word: &String| CHANGING.contains(&word.as_str()) || word.starts_with("Atomic");
        if of.iter().any(changes) {
            self.0.push(name);
        }
    }
}

impl<'a> Visit<'a> for Statics {
    fn visit_item_mod(&mut self, module: &'a ItemMod) {
        if !is_for_tests(module) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_static(&mut self, item: &'a ItemStatic) {
        let mut of = Words::default();
        of.visit_type(&item.ty);
        if matches!(item.mutability, syn::StaticMutability::Mut(_)) {
            of.0.push("Cell".to_owned());
        }
        self.note(item.ident.to_string(), &of.0);
    }

    /// `thread_local!` has statics of its own.
    fn visit_macro(&mut self, mac: &'a Macro) {
        let words = flatten(mac.tokens.clone());
        let starts: Vec<usize> = (0..words.len())
            .filter(|&at| words[at] == "static")
            .collect();
        for (index, &start) in starts.iter().enumerate() {
            let end = starts.get(index + 1).copied().unwrap_or(words.len());
            if let Some(name) = words.get(start + 1) {
                self.note(name.clone(), &words[start + 2..end]);
            }
        }
    }
}

/// Every name in a type.
#[derive(Default)]
struct Words(Vec<String>);

impl<'a> Visit<'a> for Words {
    fn visit_ident(&mut self, ident: &'a proc_macro2::Ident) {
        self.0.push(ident.to_string());
    }
}

fn parse(text: &str) -> syn::File {
    syn::parse_file(text).unwrap()
}

/// The items of a file, without its modules for tests.
fn items(text: &str) -> Vec<Item> {
    let is_kept = |item: &Item| !matches!(item, Item::Mod(module) if is_for_tests(module));
    parse(text).items.into_iter().filter(is_kept).collect()
}

fn is_for_tests(module: &ItemMod) -> bool {
    let is_test = |meta: &Meta| match meta {
        Meta::List(list) => {
            list.path.is_ident("cfg")
                && flatten(list.tokens.clone())
                    .iter()
                    .any(|word| word == "test")
        }
        _ => false,
    };
    module
        .attrs
        .iter()
        .any(|attribute| is_test(&attribute.meta))
}

/// The names in a file in their order, outside its modules for tests. Attributes, and with them
/// comments, are left out.
fn words(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    flatten(code.parse().unwrap())
}

fn flatten(tokens: TokenStream) -> Vec<String> {
    let mut words = Vec::new();
    let mut is_attribute = false;
    for token in tokens {
        match token {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                is_attribute = true;
                continue;
            }
            TokenTree::Punct(mark) if mark.as_char() == '!' && is_attribute => continue,
            TokenTree::Group(group) if is_attribute && group.delimiter() == Delimiter::Bracket => {}
            TokenTree::Group(group) => words.extend(flatten(group.stream())),
            TokenTree::Ident(ident) => words.push(ident.to_string()),
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
        is_attribute = false;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(files: &[(&str, &str)]) -> Vec<Source> {
        files
            .iter()
            .map(|(path, text)| (PathBuf::from(path), (*text).to_owned()))
            .collect()
    }

    #[test]
    fn an_operation_that_many_files_name_is_found() {
        let files = [
            ("ops/mod.rs", "pub struct Operations { pub dig: DigState }"),
            ("ops/dig.rs", "struct DigState; impl Operation for Dig {}"),
            ("ui/panel.rs", "fn f(app: &App) { app.operations.dig.g() }"),
            ("ui/dig/mod.rs", "use crate::ops::Dig;"),
            ("ui/dig/row.rs", "use crate::ops::Dig;"),
            (
                "ui/other.rs",
                "/// Of [`Dig`].\nfn f() { digging() }\n#[cfg(test)]\nmod tests { use super::Dig; }",
            ),
        ];
        let files = sources(&files);
        assert_eq!(widely_named(Path::new("ops"), &files, 4), [] as [&str; 0]);
        let found = widely_named(Path::new("ops"), &files, 3);
        assert_eq!(
            found,
            ["dig is named in 4: ops/dig.rs, ops/mod.rs, ui/dig, ui/panel.rs"]
        );
    }

    #[test]
    fn long_enums_and_fields_are_counted() {
        let files = sources(&[(
            "a.rs",
            "enum Action { A, B(u8), C { d: u8 } } enum Other { A, B, C, D }",
        )]);
        assert_eq!(
            long_enums(&files, |name| name == "Action", 2),
            ["a.rs: Action has 3 variants, not 2"]
        );
        assert_eq!(
            long_enums(&files, |name| name == "Action", 3),
            [] as [&str; 0]
        );
        let fields = fields_of("pub struct Session { pub a: u8, b: Vec<u8> }", "Session");
        assert_eq!(
            fields,
            [
                ("a".to_owned(), "u8".to_owned()),
                ("b".to_owned(), "Vec".to_owned())
            ]
        );
    }

    #[test]
    fn statics_that_change_are_found_wherever_they_stand() {
        for text in [
            "static A: std::sync::Mutex<u8> = Mutex::new(0);",
            "fn f() { static A: AtomicU64 = AtomicU64::new(0); }",
            "static A: LazyLock<RwLock<u8>> = LazyLock::new(Default::default);",
            "thread_local! { static A: Cell<bool> = const { Cell::new(false) }; }",
            "fn f() { thread_local! { pub static A: RefCell<u8> = RefCell::new(0); } }",
        ] {
            let files = sources(&[("a.rs", text)]);
            assert_eq!(unlisted_statics(&files, &[]).len(), 1, "{text}");
            assert_eq!(
                unlisted_statics(&files, &[("a.rs", "A")]),
                [] as [&str; 0],
                "{text}"
            );
        }
        let constants = "static A: LazyLock<u8> = LazyLock::new(|| 1); #[cfg(test)] mod tests { static B: Once = X; }";
        let files = sources(&[("a.rs", constants)]);
        assert_eq!(unlisted_statics(&files, &[]), [] as [&str; 0]);
        assert_eq!(
            unlisted_statics(&files, &[("a.rs", "A")]),
            ["a.rs: there is no static A that changes"]
        );
    }
}
