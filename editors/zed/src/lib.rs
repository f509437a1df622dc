//! The extension of Zed: it tells the editor how `g7 lsp` is started. Zed compiles it, as wasm.

use zed_extension_api::{self as zed, Command, LanguageServerId, Result, Worktree};

struct G7;

impl zed::Extension for G7 {
    fn new() -> G7 {
        G7
    }

    fn language_server_command(&mut self, _: &LanguageServerId, worktree: &Worktree) -> Result<Command> {
        let program = worktree.which("g7").ok_or("g7 is not on the PATH: install it by `make install`")?;
        Ok(Command { command: program, args: vec!["lsp".to_owned()], env: worktree.shell_env() })
    }
}

zed::register_extension!(G7);
