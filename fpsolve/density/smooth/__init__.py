"""The scheme for smooth fibres, equation (23): its operators and how they compose."""
