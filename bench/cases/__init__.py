"""What the benchmark times: steps, searches, whole runs, on a CPU and on a GPU."""
