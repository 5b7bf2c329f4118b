from .certifier import QUINTIC as QUINTIC
