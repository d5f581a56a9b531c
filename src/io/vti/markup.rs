//! As much of XML as VTK writes: start tags with quoted attributes, no entities that matter.

/// A start tag, and the text from its end on.
pub(super) struct Element<'a> {
    tag: &'a str,
    name: &'a str,
    after: &'a str,
}

impl<'a> Element<'a> {
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.tag;
        loop {
            let (before, after) = rest.split_once('=')?;
            let quote = after
                .trim_start()
                .chars()
                .next()
                .filter(|c| matches!(c, '"' | '\''))?;
            let (_, after) = after.split_once(quote)?;
            let (value, after) = after.split_once(quote)?;
            if before.trim() == name {
                return Some(value.trim());
            }
            rest = after;
        }
    }

    /// What stands between the start tag and its end tag: nothing for an empty element, `None` without an end tag.
    pub(super) fn inside(&self) -> Option<&'a str> {
        if self.tag.ends_with('/') {
            return Some("");
        }
        let end = self.after.find(&format!("</{}", self.name))?;
        self.after.get(..end)
    }
}

/// The first element of a name.
pub(super) fn first<'a>(text: &'a str, name: &'a str) -> Option<Element<'a>> {
    all(text, name).next()
}

/// All elements of a name, in order.
pub(super) fn all<'a>(text: &'a str, name: &'a str) -> impl Iterator<Item = Element<'a>> {
    let mut rest = text;
    std::iter::from_fn(move || {
        loop {
            let (_, at) = rest.split_once('<')?;
            rest = at;
            let Some(tag) = at.strip_prefix(name) else {
                continue;
            };
            if !tag.starts_with(|c: char| c.is_whitespace() || c == '>' || c == '/') {
                continue;
            }
            let (tag, after) = tag.split_once('>')?;
            rest = after;
            return Some(Element { tag, name, after });
        }
    })
}
