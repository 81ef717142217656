"""Many runs of one study, made once each: designs of its keys, their points, folders and workers."""
