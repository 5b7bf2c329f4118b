from .atomic import (
    check_name as check_name,
    check_regular as check_regular,
    new_draft as new_draft,
    new_file as new_file,
    read_regular as read_regular,
    recover_folder as recover_folder,
    remove_drafts as remove_drafts,
    replace_file as replace_file,
    replace_folder as replace_folder,
    try_writing_in as try_writing_in,
)
from .file_names import LONGEST_NAME as LONGEST_NAME, file_name as file_name
from .sizes import MOST as MOST
from .textfile import (
    decoded as decoded,
    parse_toml as parse_toml,
    read_hashed as read_hashed,
    read_text as read_text,
)
