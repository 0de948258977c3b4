//! Paths that code names, with `use` trees unfolded.

/// The text without comments.
pub(crate) fn without_comments(text: &str) -> String {
    let lines = text.lines().map(|line| match line.find("//") {
        // A URL in a string is no comment.
        Some(at) if !line[..at].ends_with(':') => &line[..at],
        _ => line,
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// What follows `root::`, at most two names deep, also through `root::{a, b::{c, d}}`.
pub(crate) fn paths_below(code: &str, root: &str) -> Vec<String> {
    let needle = format!("{root}::");
    let mut found = Vec::new();
    for (at, _) in code.match_indices(&needle) {
        if starts_a_path(&code[..at]) {
            unfold(&code[at + needle.len()..], "", 2, &mut found);
        }
    }
    found
}

/// Whether code names a crate: `name::…`, `use name;` or `use name as …`.
pub(crate) fn names_crate(code: &str, name: &str) -> bool {
    code.match_indices(name).any(|(at, _)| {
        let (before, after) = (&code[..at], code[at + name.len()..].trim_start());
        let imported = before.trim_end().ends_with("use") && after.starts_with([';', 'a']);
        starts_a_path(before) && (after.starts_with("::") || imported)
    })
}

/// Whether a name right after `before` is the first of its path. `::name` is: it means the crate.
fn starts_a_path(before: &str) -> bool {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    match before.strip_suffix("::") {
        Some(earlier) => !earlier.ends_with(is_name) && !earlier.ends_with('>'),
        None => !before.ends_with(is_name),
    }
}

/// Reads one path or `{…}` group at the start of `code` and returns how much of it was read.
fn unfold(code: &str, prefix: &str, depth: usize, found: &mut Vec<String>) -> usize {
    let start = code.len() - code.trim_start().len();
    let rest = &code[start..];
    if let Some(group) = rest.strip_prefix('{') {
        let mut at = start + 1;
        let end = start + 1 + group_length(group);
        while at < end {
            at += unfold(&code[at..end], prefix, depth, found).max(1);
            at = code[at..end].find(',').map_or(end, |comma| at + comma + 1);
        }
        return end + 1;
    }
    let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    if name.is_empty() {
        return start;
    }
    let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}::{name}") };
    let mut read = start + name.len();
    if let Some(deeper) = code[read..].strip_prefix("::") {
        let mut inner = Vec::new();
        read += 2 + unfold(deeper, &path, depth.saturating_sub(1), &mut inner);
        if depth > 1 {
            found.extend(inner);
        }
    }
    found.push(path);
    read
}

/// Bytes up to the brace that closes a group whose opening brace was read.
fn group_length(code: &str) -> usize {
    let mut open = 1;
    for (at, c) in code.char_indices() {
        open += match c {
            '{' => 1,
            '}' => -1,
            _ => 0,
        };
        if open == 0 {
            return at;
        }
    }
    code.len()
}

#[test]
fn use_trees_are_unfolded() {
    let sorted = |code: &str, root: &str| {
        let mut paths = paths_below(code, root);
        paths.sort();
        paths.join(" ")
    };
    for (code, root, expected) in [
        ("use crate::a::B;", "crate", "a a::B"),
        ("use crate::{a, b::{C, D}, e::F as G};", "crate", "a b b::C b::D e e::F"),
        ("use crate::{\n    a::{self, B},\n    c::d::E,\n};", "crate", "a a::B a::self c c::d"),
        ("let x = crate::a::f(crate::b::G);", "crate", "a a::f b b::G"),
        ("use std::{fs, io::{self, Read}};", "std", "fs io io::Read io::self"),
        ("pub(crate) fn f(my_crate: u8) {}", "crate", ""),
        ("use other::std::fs;", "std", ""),
        ("use ::std::fs;", "std", "fs"),
    ] {
        assert_eq!(sorted(code, root), expected, "{code}");
    }
}

#[test]
fn crates_are_told_from_modules_of_the_same_name() {
    for (code, expected) in [
        ("use mcap::Writer;", true),
        ("use mcap as bag;", true),
        ("let w = ::mcap::Writer::new();", true),
        ("use crate::io::mcap::Scan;", false),
        ("use my_mcap::Scan;", false),
        ("mod mcap_file;", false),
    ] {
        assert_eq!(names_crate(code, "mcap"), expected, "{code}");
    }
}

#[test]
fn comments_are_no_code_but_addresses_are() {
    assert_eq!(without_comments("a(); // crate::b\n/// crate::c"), "a(); \n");
    assert_eq!(without_comments("f(\"http://x\");"), "f(\"http://x\");");
}
