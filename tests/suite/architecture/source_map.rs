//! The modules of a crate as its sources declare them, and what each of them names.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::spanned::Spanned as _;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, Item, ItemMod, ItemUse, Lit, Meta, UseTree};

/// A path of names below the crate's root, or below another crate's.
pub type Names = Vec<String>;

/// A path that a module names, and the line where it does.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NamedPath {
    pub path: Names,
    pub line: usize,
}

/// One module: its file and what it names outside its tests.
#[derive(Debug, Default)]
pub struct Module {
    pub file: PathBuf,
    /// Paths into this crate, from its root.
    pub inside: Vec<NamedPath>,
    /// Paths into other crates.
    pub outside: Vec<NamedPath>,
    /// Names of what is written in the module.
    items: BTreeSet<String>,
    /// Names that the module imports or exports, and the paths that they stand for.
    aliases: BTreeMap<String, Names>,
    /// Modules whose names are imported all together.
    globs: Vec<Names>,
}

/// Every module by its path from the crate's root; the root's own path is empty.
#[derive(Debug, Default)]
pub struct SourceMap {
    pub modules: BTreeMap<Names, Module>,
    /// Every file that was read, for comparison with what lies on the disk.
    pub files: Vec<PathBuf>,
}

/// How a file is read; none where there is no such file.
type Reader<'a> = &'a dyn Fn(&Path) -> Option<String>;

impl SourceMap {
    /// Reads a crate from its root file on. Modules for tests are left out; their files count as
    /// read.
    pub fn read(root: &Path, reader: Reader<'_>) -> Self {
        let mut map = Self::default();
        map.read_file(root, &[], reader);
        map
    }

    fn read_file(&mut self, file: &Path, path: &[String], reader: Reader<'_>) {
        let text =
            reader(file).unwrap_or_else(|| panic!("{}: there is no such file", file.display()));
        let parsed =
            syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.files.push(file.to_path_buf());
        // The children of `mod.rs`, `lib.rs` and `main.rs` lie beside it, those of `name.rs` in the
        // folder `name`.
        let owns_folder = file
            .file_stem()
            .is_some_and(|stem| ["mod", "lib", "main"].iter().any(|own| stem == *own));
        let folder = if owns_folder {
            file.parent().unwrap().to_path_buf()
        } else {
            file.with_extension("")
        };
        self.read_items(&parsed.items, file, &folder, path, reader);
    }

    fn read_items(
        &mut self,
        items: &[Item],
        file: &Path,
        folder: &Path,
        path: &[String],
        reader: Reader<'_>,
    ) {
        let children: Vec<&ItemMod> = items
            .iter()
            .filter_map(|item| {
                if let Item::Mod(module) = item {
                    Some(module)
                } else {
                    None
                }
            })
            .collect();
        let items_named = items.iter().filter_map(name_of).collect();
        let mut module = Module {
            file: file.to_path_buf(),
            items: items_named,
            ..Module::default()
        };
        let names = children
            .iter()
            .map(|child| child.ident.to_string())
            .collect();
        let mut reading = Reading {
            path,
            children: names,
            module: &mut module,
        };
        for item in items {
            match item {
                Item::Mod(_) => {}
                Item::Use(item) if !is_for_tests(&item.attrs) => reading.import(item, true),
                item => reading.visit_item(item),
            }
        }
        self.modules.insert(path.to_vec(), module);
        for child in children {
            let name = child.ident.to_string();
            let below = [path, std::slice::from_ref(&name)].concat();
            let for_tests = is_for_tests(&child.attrs);
            match &child.content {
                Some(_) if for_tests => {}
                Some((_, items)) => {
                    self.read_items(items, file, &folder.join(&name), &below, reader);
                }
                None => {
                    let beside = [
                        folder.join(format!("{name}.rs")),
                        folder.join(&name).join("mod.rs"),
                    ];
                    let stated =
                        path_attribute(&child.attrs).map(|name| file.parent().unwrap().join(name));
                    let file = stated
                        .or_else(|| beside.into_iter().find(|file| reader(file).is_some()))
                        .unwrap_or_else(|| panic!("{}: no file for `mod {name}`", file.display()));
                    if for_tests {
                        self.files.push(file);
                    } else {
                        self.read_file(&file, &below, reader);
                    }
                }
            }
        }
    }

    /// The module in which the thing that a path names is written, behind every import and
    /// re-export.
    pub fn owner(&self, path: &[String]) -> Names {
        self.follow(path, 0)
    }

    fn follow(&self, path: &[String], depth: usize) -> Names {
        let mut at = Names::new();
        for (index, name) in path.iter().enumerate() {
            let below = [at.clone(), vec![name.clone()]].concat();
            if self.modules.contains_key(&below) {
                at = below;
                continue;
            }
            let Some(module) = self.modules.get(&at).filter(|_| depth < 16) else {
                return at;
            };
            let rest = &path[index + 1..];
            if let Some(target) = module.aliases.get(name) {
                let target = [target.as_slice(), rest].concat();
                // A name of another crate ends here.
                return if self.leads_inside(&target) {
                    self.follow(&target, depth + 1)
                } else {
                    at
                };
            }
            let behind_glob = module
                .globs
                .iter()
                .map(|glob| self.follow(glob, depth + 1))
                .find(|glob| {
                    let has_it = |module: &Module| {
                        module.items.contains(name) || module.aliases.contains_key(name)
                    };
                    self.modules.get(glob).is_some_and(has_it)
                });
            return match behind_glob.filter(|_| !module.items.contains(name)) {
                Some(glob) => self.follow(&[glob.as_slice(), &path[index..]].concat(), depth + 1),
                None => at,
            };
        }
        at
    }

    fn leads_inside(&self, path: &[String]) -> bool {
        path.first()
            .is_some_and(|first| self.modules.contains_key(std::slice::from_ref(first)))
    }
}

/// Reads the items of one module.
struct Reading<'a> {
    path: &'a [String],
    children: Vec<String>,
    module: &'a mut Module,
}

impl Reading<'_> {
    /// An import; those that stand outside functions give names to the module.
    fn import(&mut self, item: &ItemUse, names_it: bool) {
        self.import_tree(&item.tree, &Names::new(), names_it);
    }

    fn import_tree(&mut self, tree: &UseTree, before: &[String], names_it: bool) {
        let with = |name: String| [before, &[name]].concat();
        match tree {
            UseTree::Path(path) => {
                self.import_tree(&path.tree, &with(path.ident.to_string()), names_it);
            }
            UseTree::Group(group) => group
                .items
                .iter()
                .for_each(|tree| self.import_tree(tree, before, names_it)),
            UseTree::Name(name) => {
                let full = with(name.ident.to_string());
                let full = if name.ident == "self" {
                    before.to_vec()
                } else {
                    full
                };
                let alias = full.last().cloned().unwrap_or_default();
                self.name(full, tree.span().start().line, names_it.then_some(alias));
            }
            UseTree::Rename(name) => {
                let alias = name.rename.to_string();
                self.name(
                    with(name.ident.to_string()),
                    tree.span().start().line,
                    names_it.then_some(alias),
                );
            }
            UseTree::Glob(_) => {
                if let Some(inside) = self.name(before.to_vec(), tree.span().start().line, None) {
                    self.module.globs.extend(names_it.then_some(inside));
                }
            }
        }
    }

    /// Notes a path; returns it from the crate's root if it leads into this crate.
    fn name(&mut self, path: Names, line: usize, alias: Option<String>) -> Option<Names> {
        let inside = match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([self.path, &path[1..]].concat()),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                let above = self.path.len().checked_sub(up)?;
                Some([&self.path[..above], &path[up..]].concat())
            }
            child if self.children.iter().any(|name| name == child) => {
                Some([self.path, &path].concat())
            }
            _ => None,
        };
        if let Some(alias) = alias.filter(|alias| alias != "_") {
            self.module
                .aliases
                .insert(alias, inside.clone().unwrap_or_else(|| path.clone()));
        }
        let into = if inside.is_some() {
            &mut self.module.inside
        } else {
            &mut self.module.outside
        };
        into.push(NamedPath {
            path: inside.clone().unwrap_or(path),
            line,
        });
        inside
    }

    /// Paths within a macro's call, whose tokens are not parsed.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path = Names::new();
        let mut line = 0;
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.end_of_path(&mut path, line);
                        line = ident.span().start().line;
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                other => {
                    self.end_of_path(&mut path, line);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.end_of_path(&mut path, line);
    }

    fn end_of_path(&mut self, path: &mut Names, line: usize) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.name(path, line, None);
        }
    }
}

impl<'ast> Visit<'ast> for Reading<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_for_tests(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.import(item, false);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 {
            let names = path
                .segments
                .iter()
                .map(|segment| segment.ident.to_string())
                .collect();
            self.name(names, path.span().start().line, None);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.tokens(call.tokens.clone());
    }
}

fn name_of(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// `#[cfg(test)]`, `#[cfg(all(test, …))]` and the like.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    fn names_test(tokens: TokenStream) -> bool {
        let mut negated = false;
        tokens.into_iter().any(|token| match token {
            TokenTree::Ident(ident) => {
                negated = ident == "not";
                ident == "test" || ident == "doctest"
            }
            TokenTree::Group(group) => !negated && names_test(group.stream()),
            _ => false,
        })
    }
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || attribute.path().is_ident("cfg")
                && matches!(&attribute.meta, Meta::List(list) if names_test(list.tokens.clone()))
    })
}

/// The file that `#[path = "…"]` names.
fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    attributes
        .iter()
        .filter(|attribute| attribute.path().is_ident("path"))
        .find_map(|attribute| {
            let Meta::NameValue(pair) = &attribute.meta else {
                return None;
            };
            let Expr::Lit(value) = &pair.value else {
                return None;
            };
            if let Lit::Str(name) = &value.lit {
                Some(name.value())
            } else {
                None
            }
        })
}
