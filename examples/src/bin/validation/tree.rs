//! Commit of a page, from a clean working tree.

use std::process::Command;

use examples::CaseError;

/// Return the checked-out commit.
///
/// # Errors
/// No repository, or any files that differ from the commit: the error names the first ones.
pub fn clean_commit() -> Result<String, CaseError> {
    unchanged(&git(&["status", "--porcelain"])?)?;
    git(&["rev-parse", "HEAD"]).map(|head| head.trim().to_string())
}

/// Refuse files in the output of `git status --porcelain`.
fn unchanged(status: &str) -> Result<(), CaseError> {
    const NAMED: usize = 5;
    let files: Vec<&str> = status.lines().map(|l| l.get(3..).unwrap_or(l)).collect();
    if files.is_empty() {
        return Ok(());
    }
    let more = if files.len() > NAMED { format!(" and {} more", files.len() - NAMED) } else { String::new() };
    Err(CaseError::Other(format!(
        "working tree = {}{more} is not allowed; it must be that of a commit, without changed or new files",
        files[..files.len().min(NAMED)].join(", ")
    )))
}

fn git(arguments: &[&str]) -> Result<String, CaseError> {
    let failed = |why: &str| CaseError::Other(format!("git {}: {}", arguments.join(" "), why.trim()));
    let output = Command::new("git").args(arguments).output().map_err(|e| failed(&e.to_string()))?;
    if !output.status.success() {
        return Err(failed(&String::from_utf8_lossy(&output.stderr)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_and_new_files_are_refused_by_name() {
        assert!(unchanged("").is_ok());
        let said = |status: &str| unchanged(status).expect_err("refused").to_string();
        let two = said(" M examples/src/case.rs\n?? new.txt\n");
        assert!(two.contains("working tree = examples/src/case.rs, new.txt is not allowed"), "{two}");
        let many = said(&"?? x\n".repeat(7));
        assert!(many.contains("x, x, x, x, x and 2 more"), "{many}");
    }
}
