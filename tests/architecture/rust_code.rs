//! Just enough of Rust's lexical structure to find code among comments and literals.

/// Source without comments, strings and character literals.
pub(crate) fn code_of(source: &str) -> String {
    let mut code = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(next) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            block_comment(rest)
        } else if next == '"' {
            string(rest)
        } else if let Some(length) = raw_string(rest) {
            length
        } else if next == '\'' {
            character(rest)
        } else if next.is_alphanumeric() || next == '_' {
            // Whole words, so that the `r` of `for"` does not start a raw string.
            let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'));
            let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
            code += word;
            rest = after;
            continue;
        } else {
            code.push(next);
            rest = &rest[next.len_utf8()..];
            continue;
        };
        code.push(' ');
        rest = &rest[skipped..];
    }
    code
}

/// Length of a block comment, nested ones included.
fn block_comment(source: &str) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at < source.len() {
        let rest = &source.as_bytes()[at..];
        let step = match rest {
            [b'/', b'*', ..] => {
                depth += 1;
                2
            }
            [b'*', b'/', ..] => {
                depth -= 1;
                2
            }
            _ => 1,
        };
        at += step;
        if depth == 0 {
            break;
        }
    }
    at
}

/// Length of a string literal.
fn string(source: &str) -> usize {
    let mut escaped = false;
    for (at, c) in source.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    source.len()
}

/// Length of a raw string literal, if one starts here.
fn raw_string(source: &str) -> Option<usize> {
    let prefix = ["r", "br", "cr"].into_iter().find(|prefix| {
        source.starts_with(&format!("{prefix}\"")) || source.starts_with(&format!("{prefix}#"))
    })?;
    let hashes = source[prefix.len()..]
        .bytes()
        .take_while(|&b| b == b'#')
        .count();
    let start = prefix.len() + hashes + 1;
    if source.as_bytes().get(start - 1) != Some(&b'"') {
        return None; // a raw identifier
    }
    let end = format!("\"{}", "#".repeat(hashes));
    Some(
        source[start..]
            .find(&end)
            .map_or(source.len(), |at| start + at + end.len()),
    )
}

/// Length of a character literal, or of the quote of a lifetime.
fn character(source: &str) -> usize {
    let mut chars = source.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some((escaped, c))) => {
            let after = escaped + c.len_utf8();
            source[after..]
                .find('\'')
                .map_or(source.len(), |at| after + at + 1)
        }
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 1,
    }
}

#[test]
fn comments_and_literals_are_no_code() {
    let words = |source| -> Vec<String> {
        let code = code_of(source);
        code.split_whitespace().map(str::to_owned).collect()
    };
    assert_eq!(words("a // b\nc"), ["a", "c"]);
    assert_eq!(words("a /* b /* c */ d */ e"), ["a", "e"]);
    assert_eq!(words(r#"a "b \" c" d"#), ["a", "d"]);
    assert_eq!(words("a r#\"b \" c\"# d"), ["a", "d"]);
    assert_eq!(words("for\"b\""), ["for"]);
    assert_eq!(words("r#type b"), ["r#type", "b"]);
    assert_eq!(words(r"a '\'' b 'c' d"), ["a", "b", "d"]);
    assert_eq!(words("&'a str"), ["&", "a", "str"]);
}
