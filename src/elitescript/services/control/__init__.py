"""The local channel of `elitescript ctl` and its verbs."""
