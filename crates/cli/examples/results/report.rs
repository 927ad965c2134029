//! The Markdown file and the pictures beside it.

use std::path::{Path, PathBuf};

pub(crate) struct Report {
    folder: PathBuf,
    text: String,
}

impl Report {
    /// Writes to `folder`/RESULTS.md and `folder`/images.
    pub(crate) fn new(folder: &Path) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder.join("images"))?;
        Ok(Self { folder: folder.to_owned(), text: String::new() })
    }

    pub(crate) fn heading(&mut self, text: &str) {
        eprintln!("{text}");
        self.say(&format!("## {text}"));
    }

    /// A paragraph.
    pub(crate) fn say(&mut self, text: &str) {
        self.text.push_str(text.trim_end());
        self.text.push_str("\n\n");
    }

    /// The first column to the left, all others to the right.
    pub(crate) fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let line = |cells: &mut dyn Iterator<Item = &str>| {
            let mut line = String::from("|");
            for cell in cells {
                line.push_str(&format!(" {cell} |"));
            }
            line.push('\n');
            line
        };
        self.text.push_str(&line(&mut head.iter().copied()));
        self.text.push_str("|---|");
        self.text.push_str(&"---:|".repeat(head.len() - 1));
        self.text.push('\n');
        for row in rows {
            eprintln!("  {}", row.join(" | "));
            self.text.push_str(&line(&mut row.iter().map(String::as_str)));
        }
        self.text.push('\n');
    }

    /// Writes a picture and gives its path as the text names it.
    pub(crate) fn image(&mut self, name: &str, bytes: &[u8]) -> std::io::Result<String> {
        std::fs::write(self.folder.join("images").join(name), bytes)?;
        Ok(format!("images/{name}"))
    }

    pub(crate) fn write(&self) -> std::io::Result<()> {
        std::fs::write(self.folder.join("RESULTS.md"), self.text.trim_end().to_owned() + "\n")
    }
}
