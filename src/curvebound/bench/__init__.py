"""What the FMUs cost, measured beside C and beside the general tools one could take instead."""
