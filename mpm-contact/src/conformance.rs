//! What every law and detector must do.
